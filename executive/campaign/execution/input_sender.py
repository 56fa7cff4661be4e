"""Sends inputs to the caches of workers: each input once a cache, before the first run needs it."""

import errno
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from distributed import Client

from executive.campaign.execution.cluster_workers import ClusterError, has_left
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.inputs import chunks_of, digest_of, stamp_of
from executive.campaign.execution.worker_run import complete, lacks, receive

_PATIENCE_S = 120.0  # with a worker that is sent a part of an input or verifies one


class InputSender:
    """Knows the inputs of this computer by digest, and which cache of the cluster holds which."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._digests: dict[Path, tuple[object, str]] = {}  # stamp and digest by path
        self._held: dict[str, set[str]] = {}  # caches by digest

    def digests(self, inputs: Mapping[str, Path]) -> dict[str, str]:
        """Return the digest of each input by its name; a file is read once while it is unchanged.

        Raises:
            ConfigError: If one does not exist, or its content has changed since the campaign's
                first run with it: results before and after would not be comparable.
        """
        return {name: self._digest(path.resolve()) for name, path in inputs.items()}

    def send(
        self,
        inputs: Mapping[str, Path],
        digests: Mapping[str, str],
        to: str,
        caches: Mapping[str, str],
    ) -> None:
        """Send to a worker's cache what it lacks.

        An input that some other cache has already goes to all caches at once: it is one of those
        that many runs read, and passes from here to the scheduler only once for all of them.

        Args:
            inputs: Local path by the input's name.
            digests: Digest by the input's name.
            to: Address of the worker.
            caches: The cache of each worker by its address.

        Raises:
            ClusterError: If an input arrived with another content.
            DiskFullError: If a worker has no space for it.
        """
        for name, path in inputs.items():
            held = self._held.setdefault(digests[name], set())
            if caches[to] in held:
                continue
            lacking = {cache: address for address, cache in caches.items() if cache not in held}
            chosen = lacking if held else {caches[to]: to}
            reached = self._send(path.resolve(), digests[name], list(chosen.values()))
            held.update(cache for cache, address in chosen.items() if address in reached)

    def forget(self, digests: Iterable[str], cache: str) -> None:
        """Note that a cache does not hold some inputs (any more)."""
        for digest in digests:
            self._held.get(digest, set()).discard(cache)

    def _digest(self, path: Path) -> str:
        stamp = stamp_of(path)
        known = self._digests.get(path)
        if known and known[0] == stamp:
            return known[1]
        digest = digest_of(path)
        if known and known[1] != digest:
            raise ClusterError(
                f"input {path} has changed while the campaign was going on. Put the earlier "
                "content back and go on with --resume, or begin a new campaign"
            )
        self._digests[path] = (stamp, digest)
        return digest

    def _send(self, path: Path, digest: str, workers: list[str]) -> set[str]:
        """Send an input to workers, and return those that have it now."""
        lacking = self._asked(workers, lacks, digest)
        present = {address for address, is_lacking in lacking.items() if not is_lacking}
        reached = [address for address in lacking if address not in present]
        for chunk in chunks_of(path) if reached else ():
            reached = list(self._asked(reached, receive, digest, chunk))
        return present | set(self._asked(reached, complete, digest))

    def _asked(
        self, workers: list[str], function: Callable[..., Any], *args: object
    ) -> dict[str, Any]:
        """Call a function on workers, and return what those answered that are still there."""
        if not workers:
            return {}
        try:
            answers = self._client.run(
                function, *args, workers=workers, on_error="return", callback_timeout=_PATIENCE_S
            )
        except TimeoutError:  # a worker hangs; orders to the others ask for what they lack
            return {}
        for address, answer in answers.items():
            if isinstance(answer, OSError) and answer.errno in (errno.ENOSPC, errno.EDQUOT):
                raise DiskFullError(f"worker {address} has no space left for inputs: {answer}")
            if isinstance(answer, Exception) and not has_left(answer):
                raise ClusterError(f"worker {address} did not take an input: {answer}")
        return {one: said for one, said in answers.items() if not isinstance(said, Exception)}
