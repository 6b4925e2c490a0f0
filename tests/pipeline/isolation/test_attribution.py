"""Who is at work is known, whatever ends the work."""

from collections.abc import Callable
from pathlib import Path

import pytest

from dh2urdf.isolation.attribution import Attribution, Plugin, current
from dh2urdf.isolation.child_process import PLAIN, Child, pickled_call

LAB = Plugin(name="lab = lab_lab", distribution="lab 1.0")


class TestInThisProcess:
    def test_the_innermost_is_at_work(self) -> None:
        """Until it ends; then the one that called it."""
        assert current() is None
        with Attribution("executor 'threads'", LAB):
            with Attribution("emitter 'usd'", LAB):
                assert str(current()) == "emitter 'usd' of lab 1.0"
            assert str(current()) == "executor 'threads' of lab 1.0"
        assert current() is None

    def test_an_interrupt_names_the_innermost(self) -> None:
        """Once, as a note that the command line prints; other exceptions stay as they are."""
        with (
            pytest.raises(KeyboardInterrupt) as caught,
            Attribution("executor 'threads'", LAB),
            Attribution("emitter 'usd'", LAB),
        ):
            raise KeyboardInterrupt
        assert caught.value.__notes__ == ["emitter 'usd' of lab 1.0 was at work"]
        with pytest.raises(KeyError) as other, Attribution("emitter 'usd'", LAB):
            raise KeyError
        assert not hasattr(other.value, "__notes__")


class TestInAChild:
    @pytest.mark.parametrize(
        ("ending", "who"),
        [
            ("os._exit(3)", "emitter 'usd' of lab 1.0"),
            ("os.kill(os.getpid(), 9)", "emitter 'usd' of lab 1.0"),
            ("raise SystemExit", ""),
            ("subprocess.run([sys.executable, '-c', 'import dh2urdf.isolation.attribution'])", ""),
        ],
    )
    def test_the_parent_knows(
        self, tmp_path: Path, install: Callable[..., None], monkeypatch: pytest.MonkeyPatch, ending: str, who: str
    ) -> None:
        """However the child ended; nobody is named where it ended by itself."""
        install(tmp_path, "lab", "")
        monkeypatch.syspath_prepend(tmp_path)
        script = (
            "import os, subprocess, sys\nfrom dh2urdf.isolation.attribution import Attribution, Plugin\n"
            "with Attribution('executor \\'here\\'', None):\n"
            f"    with Attribution('emitter \\'usd\\'', Plugin(name='lab = lab_lab', distribution='lab 1.0')):\n        {ending}\n"
        )
        assert who_was_at_work(script) == who


def who_was_at_work(script: str) -> str:
    """Who was at work in a child when it had done a script."""
    with Child() as child:
        child.ask(pickled_call(exec, (script, {}), "it"), 60, PLAIN)
    return child.who
