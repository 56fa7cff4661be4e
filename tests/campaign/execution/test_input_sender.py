"""An input goes once to each cache that lacks it, without a cluster."""

import errno

import pytest

from executive.campaign.execution.cluster_workers import ClusterError
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.input_sender import InputSender
from executive.campaign.execution.worker_run import complete, lacks, receive

CACHES = {"w1": "cache a", "w2": "cache b", "w3": "cache b"}


class Client:
    """Answers for workers, and notes who is sent what; `answer` replaces an answer."""

    def __init__(self, answer=lambda function, worker: None):
        self.sent, self.complete, self._answer = [], set(), answer

    def run(self, function, digest, chunk=None, *, workers, on_error, callback_timeout):
        assert on_error == "return"
        assert callback_timeout > 0
        answers = {}
        for worker in workers:
            replaced = self._answer(function, worker)
            if isinstance(replaced, TimeoutError):
                raise replaced
            if replaced is not None:
                answers[worker] = replaced
            elif function is lacks:
                answers[worker] = (worker, digest) not in self.complete
            elif function is receive:
                self.sent.append((worker, chunk.content))
                answers[worker] = None
            else:
                assert function is complete
                self.complete.add((worker, digest))
                answers[worker] = None
        return answers


@pytest.fixture
def stones(tmp_path):
    path = tmp_path / "stones.txt"
    path.write_text("three stones")
    return path


def send(client, path, to="w1", sender=None):
    sender = sender or InputSender(client)
    digests = sender.digests({"stones": path})
    sender.send({"stones": path}, digests, to, CACHES)
    return sender, digests


def test_the_first_cache_alone_is_sent_an_input_and_only_once(stones):
    client = Client()
    sender, _ = send(client, stones)
    assert client.sent == [("w1", b"three stones")]
    send(client, stones, sender=sender)
    assert len(client.sent) == 1


def test_an_input_that_a_second_cache_needs_goes_to_all_that_lack_it_once_a_cache(stones):
    client = Client()
    sender, _ = send(client, stones)
    send(client, stones, to="w2", sender=sender)
    assert len(client.sent) == 2  # two workers share the second cache
    send(client, stones, to="w3", sender=sender)
    assert len(client.sent) == 2


def test_a_worker_that_has_an_input_already_is_not_sent_it(stones):
    client = Client(lambda function, _: False if function is lacks else None)
    sender, _ = send(client, stones)
    send(client, stones, sender=sender)
    assert client.sent == []


def test_a_cache_that_has_dropped_an_input_is_sent_it_again(stones):
    client = Client()
    sender, digests = send(client, stones)
    client.complete.clear()
    sender.forget(digests.values(), "cache a")
    send(client, stones, sender=sender)
    assert len(client.sent) == 2


@pytest.mark.parametrize("gone", [ConnectionError("gone"), OSError("no connection")])
def test_a_worker_that_has_left_is_passed_over_and_counts_as_without_the_input(stones, gone):
    client = Client(lambda function, _: gone if function is receive else None)
    sender, _ = send(client, stones)
    assert not client.complete
    sender_client = Client()
    sender._client = sender_client
    send(sender_client, stones, sender=sender)
    assert len(sender_client.sent) == 1


def test_workers_that_hang_end_nothing(stones):
    client = Client(lambda function, _: TimeoutError())
    send(client, stones)
    assert client.sent == []


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT])
def test_a_full_disk_is_told_with_its_worker(stones, number):
    client = Client(lambda function, _: OSError(number, "full") if function is receive else None)
    with pytest.raises(DiskFullError, match="worker w1 has no space left"):
        send(client, stones)


def test_an_input_that_arrives_otherwise_is_told_with_its_worker(stones):
    client = Client(lambda function, _: ValueError("bytes") if function is complete else None)
    with pytest.raises(ClusterError, match="worker w1 did not take an input: bytes"):
        send(client, stones)


def test_an_input_may_not_change_while_the_campaign_goes_on(stones):
    sender = InputSender(Client())
    first = sender.digests({"stones": stones})
    assert sender.digests({"again": stones}) == {"again": first["stones"]}
    stones.write_text("four stones, and more")
    with pytest.raises(ClusterError, match="has changed while the campaign was going on"):
        sender.digests({"stones": stones})
