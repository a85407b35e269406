"""Does what docs/python.md shows do what it says, as it stands there?"""

import re
import subprocess
import sys
from pathlib import Path

import energywave as ew
import pytest

PAGE = (Path(__file__).parents[3] / "docs/python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)


def run(code, folder):
    command = [sys.executable, "-W", "error::DeprecationWarning:__main__", "-c", code]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def test_the_code_of_the_page_runs_as_written(tmp_path):
    """One block after the other, in an empty folder, in a Python of its own."""
    assert len(BLOCKS) == 3
    if not any(device.type != "reference" for device in ew.devices()):
        pytest.skip("its last block needs OpenCL")
    pytest.importorskip("pyopencl")
    done = run("\n".join([*BLOCKS, "assert light.shape == (360, 640, 4) and light[..., :3].max() > 0"]), tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "ring.png").stat().st_size > 1000
    mistaken = run(BLOCKS[0].replace("ew.render(", "ew.rendre("), tmp_path)
    assert mistaken.returncode != 0 and "rendre" in mistaken.stderr


def test_the_tables_of_the_page_name_what_there_is():
    calls = set(re.findall(r"^\| `(?:Renderer\(\)\.)?(\w+)\(", PAGE, re.MULTILINE))
    assert {"render", "render_into", "integrate", "devices"} <= calls
    missing = [name for name in calls if not hasattr(ew, name) and not hasattr(ew.Renderer, name)]
    assert missing == [] and not hasattr(ew, "rendre")
    errors = [name for name in ew.__all__ if name.endswith("Error") and name not in ("Error",)]
    unsaid = [name for name in errors if f"`{name}`" not in PAGE]
    assert unsaid == [] and len(errors) > 8
