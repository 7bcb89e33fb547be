"""Packs that misbehave, each as its source, installed beside a good one."""

import signal
from pathlib import Path

HEAD = """
from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.hookspecs import hookimpl

class BadConfig(ParserConfig):
    sharpness: int = 1
    def build(self):
        return None
"""

GOOD = """
from prime_core.contracts.parser import Parser, ParserConfig
from prime_core.hookspecs import hookimpl

class GoodConfig(ParserConfig):
    sharpness: int = 1
    def build(self):
        return None

@hookimpl
def register_parsers(register):
    register("good/scissors", GoodConfig)

@hookimpl
def register_commands(register):
    def cut(paper: str = "paper") -> None:
        "Cut."
        import subprocess, sys
        print("cut", paper)
        sys.stdout.flush()
        subprocess.run(["echo", "in two"], check=True)
    register("cut", cut)
"""


def install(folder: Path, distribution: str, module: str, source: str, entry: str = "") -> None:
    """Install a pack of one module, as pip leaves it.

    Args:
        folder: That is on the path.
        distribution: Its name.
        module: Name of its module.
        source: Of the module.
        entry: Text of its entry points; by default one that is called as the module is.
    """
    (folder / f"{module}.py").write_text(source, encoding="utf-8")
    metadata = folder / f"{distribution.replace('-', '_')}-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n"
    )
    text = entry or f"[prime]\n{module} = {module}\n"
    (metadata / "entry_points.txt").write_text(text)


def listen() -> None:
    """Let a new process hear Ctrl-C: background jobs of a shell ignore it, and hand that on."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def registering(body: str) -> str:
    """Return a pack whose hook for parsers does something."""
    inner = body.strip().replace("\n", "\n    ")
    return f"{HEAD}\n@hookimpl\ndef register_parsers(register):\n    {inner}\n"


def commanding(body: str) -> str:
    """Return a pack whose hook for commands does something, and that has a parser."""
    inner = body.strip().replace("\n", "\n    ")
    return (
        registering('register("bad/saw", BadConfig)')
        + f"\n@hookimpl\ndef register_commands(register):\n    {inner}\n"
    )


FAILING = {
    "raises-at-import": "raise RuntimeError('no driver [/] here')",
    "exits-at-import": "import sys; sys.exit(0)",
    "exits-with-a-text": "raise SystemExit('bye')",
    "interrupts-at-import": "raise KeyboardInterrupt",
    "ends-by-a-base-exception": "class Stop(BaseException): pass\nraise Stop('now')",
    "leaves-a-generator": "raise GeneratorExit",
    "has-an-error-without-text": (
        "class Odd(Exception):\n    def __str__(self): raise ValueError\nraise Odd"
    ),
    "is-no-python": "def (:",
    "asks-at-import": "from prime_core.registry.loading import load_plugins; load_plugins()",
    "has-no-hook": "x = 1",
    "raises-when-looked-at": "def __dir__(): raise RuntimeError('not at home')",
    "exits-in-a-hook": registering('import sys\nregister("bad/saw", BadConfig)\nsys.exit(3)'),
    "interrupts-in-a-hook": registering("raise KeyboardInterrupt"),
    "registers-then-raises": registering('register("bad/saw", BadConfig)\nraise OSError("gone")'),
    "a-class-twice-then-raises": registering(
        'register("bad/saw", BadConfig)\nregister("bad/saw", BadConfig)\nraise OSError("gone")'
    ),
    "another-pack's-class-then-raises": registering(
        'from good import GoodConfig\nregister("bad/saw", GoodConfig)\nraise OSError("gone")'
    ),
    "two-things-under-a-name": registering(
        'class Other(BadConfig): pass\nregister("bad/saw", BadConfig)\nregister("bad/saw", Other)'
    ),
    "no-settings-class": registering('register("bad/saw", lambda: None)'),
    "an-instance": registering('register("bad/saw", BadConfig())'),
    "an-unfinished-class": registering(
        'class Rough(ParserConfig): pass\nregister("bad/saw", Rough)'
    ),
    "a-field-called-type": registering(
        'class Typed(BadConfig):\n    type: str = "good/scissors"\nregister("bad/saw", Typed)'
    ),
    "no-name": registering('register("", BadConfig)'),
    "a-name-of-markup": registering('register("[/red]", BadConfig)'),
    "a-name-that-is-a-class": registering("register(BadConfig, BadConfig)"),
    "a-generator": registering('register("bad/saw", BadConfig)\nyield 1\nraise OSError("gone")'),
    "a-coroutine": registering('register("bad/saw", BadConfig)').replace(
        "\ndef r", "\nasync def r"
    ),
    "asks-what-is-registered": registering(
        "from prime_core.registry.loading import load_plugins\n"
        'registry = load_plugins().registry\nregistry._entries["parser"].clear()'
    ),
    "a-wrapper-that-raises": registering('yield\nraise OSError("gone")').replace(
        "@hookimpl", "@hookimpl(wrapper=True)"
    ),
    "a-wrapper-that-never-yields": registering("return\nyield").replace(
        "@hookimpl", "@hookimpl(wrapper=True)"
    ),
    "an-unknown-hook": registering("pass").replace("def register_parsers", "def register_saws"),
    "no-function-as-a-command": commanding('register("saw", 3)'),
    "a-command-that-is-none": commanding(
        'def saw(wood: "NoSuchName") -> None: ...\nregister("saw", saw)'
    ),
    "exits-for-commands": commanding("raise SystemExit(4)"),
}
"""Packs that cannot be loaded; nothing of them is registered."""

WORKING = {
    "prints": "import os, sys\nprint('NOISE')\nsys.__stdout__.write('NOISE')\n"
    "os.system('echo NOISE')\nos.write(1, b'NOISE')\n"
    + registering("print('NOISE')\nregister('bad/saw', BadConfig)"),
    "prints-at-the-end": "import atexit\natexit.register(print, 'NOISE')\n"
    + registering("register('bad/saw', BadConfig)"),
    "closes-streams": "import sys\nsys.stdout.close()\nsys.stdin = None\nsys.stderr = None\n"
    + registering("import sys\nsys.stdout.close()\nregister('bad/saw', BadConfig)"),
    "configures-everything": """
import logging, os, signal, sys, warnings
warnings.filterwarnings("error")
logging.basicConfig(stream=sys.stdout, level=0)
logging.disable(logging.CRITICAL)
signal.signal(signal.SIGINT, signal.SIG_IGN)
os.chdir("/")
sys.argv[:] = ["prime", "compare"]
sys.setrecursionlimit(120)
sys.excepthook = None
"""
    + registering("register('bad/saw', BadConfig)"),
    "compares-as-it-likes": registering("""
class Kind(type(BadConfig)):
    def __hash__(self): raise RuntimeError
    def __eq__(self, other): return True
class Equal(BadConfig, metaclass=Kind): pass
class Name(str):
    def __hash__(self): return hash("good/scissors")
    def __eq__(self, other): return True
register(Name("bad/saw"), Equal)
"""),
    "takes-away-what-all-need": """
import builtins, os, sys
sys.path.clear()
sys.path = []
sys.path_hooks.clear()
sys.meta_path.clear()
builtins.open = builtins.print = None
os.environ.clear()
os.umask(0o777)
"""
    + registering("register('bad/saw', BadConfig)"),
    "takes-names": registering(
        "from good import GoodConfig\n"
        "for name in ('good/scissors', 'dp', 'greedy', 'bad/saw'): register(name, BadConfig)\n"
        "register('bad/scissors', GoodConfig)"
    ),
    "takes-commands": commanding(
        "for name in ('run', 'validate', 'plugins', 'compare', 'show', 'parse', 'saw'):\n"
        "    register(name, lambda: print('NOISE'))"
    ),
    "wraps": registering("register('bad/saw', BadConfig)\nyield\nreturn []").replace(
        "@hookimpl", "@hookimpl(wrapper=True, tryfirst=True)"
    ),
    "wraps-as-of-old": registering(
        "register('bad/saw', BadConfig)\n(yield).force_result([])"
    ).replace("@hookimpl", "@hookimpl(hookwrapper=True, trylast=True)"),
    "spoils-what-it-is-given": registering(
        "register('bad/saw', BadConfig)\n"
        "for cell in register.__closure__:\n"
        "    if isinstance(cell.cell_contents, list): kept = cell.cell_contents\n"
        "import prime_core.hookspecs as hookspecs\n"
        "del hookspecs.register_policies"
    ),
    "fails-when-read": HEAD.replace(
        "sharpness: int = 1",
        "sharpness: int = 1\n    def model_post_init(self, _): raise KeyError('edge')",
    )
    + "\n@hookimpl\ndef register_parsers(register):\n    register('bad/saw', BadConfig)\n",
}
"""Packs that can be loaded, and spoil nothing."""
