import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))  # faulty_files and consumers, which these tests share


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The sound file, and the one that breaks each rule."""
    from faulty_files import write_all

    return write_all(tmp_path_factory.mktemp("lint"))
