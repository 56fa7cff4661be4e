"""The frames of a thread that hangs tell where it does."""

import threading

from executive.mission.jobs.stack import frames_of_thread


def test_the_frames_of_a_thread_come_outermost_first_and_those_of_an_ended_one_are_none() -> None:
    begun, end = threading.Event(), threading.Event()

    def hangs() -> None:
        begun.set()
        end.wait()

    thread = threading.Thread(target=hangs)
    thread.start()
    assert begun.wait(20)
    names = [frame.f_code.co_name for frame, _ in frames_of_thread(thread.ident)]
    end.set()
    thread.join(20)
    assert names[0] == "_bootstrap"
    assert "hangs" in names[1:]
    assert frames_of_thread(thread.ident) == []
