"""The page on robots shows the loop that is there, and its links lead somewhere."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"
PAGE = (DOCS / "robot.md").read_text(encoding="utf-8")


def test_the_loop_is_the_one_that_runs() -> None:
    blocks = re.findall(r'```python title="([^"]+)"\n(.*?)\n```', PAGE, flags=re.DOTALL)
    assert [name for name, _ in blocks] == ["robot_loop.py"]
    for name, text in blocks:
        assert text in (DOCS / "examples" / name).read_text(encoding="utf-8")


def test_links_lead_somewhere() -> None:
    links = re.findall(r"\]\((?!https://)([^)#]+)\)", PAGE)
    assert len(links) > 1
    assert [link for link in links if not (DOCS / link).exists()] == []
