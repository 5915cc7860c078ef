"""What an action, a timer or a job raises is reported, and the others are still done."""

import queue

from scenic.lsp.loop import Job, Loop, Worker


def test_faults_end_nothing() -> None:
    reported: list[Exception] = []
    done: queue.SimpleQueue[str] = queue.SimpleQueue()
    loop = Loop(reported.append)
    worker = Worker("jobs")

    def fail(*_: object) -> None:
        raise RecursionError

    def finish(_: Job) -> None:
        done.put("job")
        loop.put(loop.stop)

    loop.put(fail)
    loop.put(lambda: done.put("action"))
    loop.call_later(0, fail)
    loop.call_later(0, lambda: done.put("timer"))
    worker.put(Job(fail, loop))
    loop.call_later(0.001, lambda: worker.put(Job(finish, loop)))
    loop.run()
    assert {done.get(timeout=10) for _ in range(3)} == {"action", "timer", "job"}
    assert [type(error) for error in reported] == [RecursionError] * 3
