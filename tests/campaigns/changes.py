"""Changes of files that know nothing of their content, or that it is a tree of plain values."""

import copy
import json
import random
from collections.abc import Callable
from typing import Any

import yaml

CANARY = "canary-of-the-campaign"
"""Name of the file that appears in the working folder if an input was run as code."""

DEEP = 100_000


def pickle_bomb() -> bytes:
    """Return a pickle that makes the canary."""
    return b"cos\nsystem\n(S'touch " + CANARY.encode() + b"'\ntR."


def flip_bits(data: bytes, draw: random.Random) -> bytes:
    """Flip 1 to 30 bits."""
    changed = bytearray(data)
    for _ in range(draw.choice((1, 1, 1, 4, 30))):
        changed[_place(data, draw)] ^= 1 << draw.randrange(8)
    return bytes(changed)


def set_bytes(data: bytes, draw: random.Random) -> bytes:
    """Set 1 to 8 bytes in a row to what is great, small or at random."""
    start, count = _place(data, draw), draw.choice((1, 4, 8))
    kind = draw.choice((b"\x00", b"\xff", b"\x7f", b"\x80", None))
    new = draw.randbytes(count) if kind is None else kind * count
    return data[:start] + new + data[start + count :]


def truncate(data: bytes, draw: random.Random) -> bytes:
    """Cut off the end."""
    return data[: draw.choice((0, 1, len(data) - 1, draw.randrange(len(data))))]


def cut_out(data: bytes, draw: random.Random) -> bytes:
    """Take a block away."""
    start = _place(data, draw)
    return data[:start] + data[start + draw.randint(1, 64) :]


def insert(data: bytes, draw: random.Random) -> bytes:
    """Put a block of noise, spaces or zeros somewhere."""
    start, count = _place(data, draw), draw.choice((1, 16, 5000))
    block = draw.choice((draw.randbytes(count), b" " * count, bytes(count)))
    return data[:start] + block + data[start:]


def duplicate(data: bytes, draw: random.Random) -> bytes:
    """Give a block twice, or all of it."""
    start, count = draw.choice(((0, len(data)), (_place(data, draw), draw.randint(1, 512))))
    return data[: start + count] + data[start : start + count] + data[start + count :]


def zero(data: bytes, draw: random.Random) -> bytes:
    """Fill a block with zeros, as after a crash of the machine."""
    start, count = _place(data, draw), draw.choice((16, 512, 4096))
    return data[:start] + bytes(len(data[start : start + count])) + data[start + count :]


def _place(data: bytes, draw: random.Random) -> int:
    """Draw a place, often near the beginning or the end, where formats keep what is where."""
    size = max(len(data), 1)
    near = min(size, 2000)
    return draw.choice(
        (draw.randrange(size), draw.randrange(near), size - 1 - draw.randrange(near))
    )


BLIND: list[Callable[[bytes, random.Random], bytes]] = [
    *[flip_bits] * 4,
    set_bytes,
    truncate,
    cut_out,
    insert,
    duplicate,
    zero,
]
"""Changes of bytes, the likelier ones several times."""


def _deep(depth: int) -> Any:
    value: Any = 1
    for number in range(depth):
        value = [value] if number % 2 else {"a": value}
    return value


def evil_values(draw: random.Random) -> list[Any]:
    """Return values of all kinds; each may stand where another was."""
    long = 10 ** draw.choice((30, 400, 3000))
    return [
        *(None, True, False, 0, -1, 1, 2**31, 2**63, 2**64, -(2**63) - 1, long, -long),
        *(0.0, -0.5, 1e-320, 1e308, -1e308, float("nan"), float("inf"), float("-inf")),
        *("", " ", "0", "1e5", "null", "a" * 100_000, "\x00", "../../neighbour", "/dev/zero"),
        *(
            "\u202e\U0001f600\u0000x",
            "[/red] [bold]",
            "%s %n {0} {x.__class__}",
            "\n\n\n",
            "\x1b[2J",
        ),
        *("{chunk_index:999999999d}", "{chunk_index.__class__}", "../../neighbour/x.parquet"),
        *([], {}, [[]], {"": {}}, [None] * 1000, {"type": "os.system"}, [[1, 2], [3]]),
        {f"key {number}": number for number in range(200)},
        *(_deep(20), _deep(300), list(range(5000)), "!!python/name:os.system"),
        {"#type": "Pickle", "filename": "../../../../given/pickled"},
        {"type": "robosuite-hdf5", "path": "/dev/zero"},
        {"type": "lerobot", "path": "../neighbour"},
    ]


def change_tree(value: Any, draw: random.Random) -> Any:
    """Return plain values with 1 to 3 of them changed, dropped, renamed or given twice."""
    changed = copy.deepcopy(value)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        places = list(_places(changed))
        if not places:
            return draw.choice(evil_values(draw))
        holder, key = draw.choice(places)
        _change(holder, key, draw)
    if draw.random() < 0.03:
        return draw.choice(evil_values(draw))
    return changed


def _places(value: Any) -> list[tuple[Any, Any]]:
    """Return holders and keys, those that lie deep no more often than those that do not."""
    levels: list[list[tuple[Any, Any]]] = []
    waiting = [value]
    while waiting and len(levels) < 8:
        here = [
            (holder, key)
            for holder in waiting
            for key in (holder if isinstance(holder, dict) else range(len(holder)))
        ]
        levels.append(here)
        waiting = [h[k] for h, k in here if isinstance(h[k], (dict, list))]
    most = max(map(len, levels), default=0)
    return [place for level in levels for place in level * min(20, most // max(len(level), 1) + 1)]


def _change(holder: Any, key: Any, draw: random.Random) -> None:
    kind = draw.choice(("value", "value", "value", "near", "drop", "rename", "swap"))
    if kind == "drop":
        del holder[key]
    elif kind == "rename" and isinstance(holder, dict):
        new = draw.choice(
            ("", "x" * 300, "\u00e9", f"{key}2", f"{key}"[::-1], "__class__", "a.b/../c")
        )
        holder[new] = holder.pop(key)
    elif kind == "swap":
        other = draw.choice(list(holder) if isinstance(holder, dict) else range(len(holder)))
        holder[key], holder[other] = holder[other], holder[key]
    elif kind == "near" and isinstance(holder[key], (int, float)):
        holder[key] = draw.choice(
            (holder[key] + 1, -holder[key], holder[key] * 1000, f"{holder[key]}")
        )
    else:
        holder[key] = draw.choice(evil_values(draw))


def change_json(data: bytes, draw: random.Random) -> bytes:
    """Change values of a JSON file, or what only its text can say."""
    text = data.decode()
    if draw.random() < 0.8:
        return json.dumps(change_tree(json.loads(text), draw)).encode()
    return draw.choice(
        (
            b"[" * DEEP,
            b'{"a":' * DEEP + b"1" + b"}" * DEEP,
            b"\xef\xbb\xbf" + data,
            text.encode("utf-16"),
            data + data,
            data.replace(b": ", b": 1e999, ", 1),
            data.replace(b"1", b"9" * 5000, 1),
            b'{"name": "\\ud800", ' + data.lstrip()[1:],
            b"null",
            b'""',
            data.replace(b'"', b"'"),
        )
    )


def change_yaml(data: bytes, draw: random.Random) -> bytes:
    """Change values of a YAML file, or what only its text can say."""
    if draw.random() < 0.75:
        tree = change_tree(yaml.safe_load(data), draw)
        return yaml.safe_dump(tree, sort_keys=False, allow_unicode=True).encode("utf-8", "replace")
    laughs = "\n".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 12))
    merges = "\n".join(
        f"m{n}: &m{n} {{<<: [{', '.join([f'*m{n - 1}'] * 9)}]}}" for n in range(1, 9)
    )
    touch = f"touch {CANARY}"
    lines = (
        f"x: !!python/object/apply:os.system ['{touch}']",
        f"seed: !!python/object/apply:subprocess.check_output [['touch', '{CANARY}']]",
        "name: !!python/object/new:type {args: [z, !!python/tuple [], "
        f'{{extend: !!python/name:exec}}], listitems: \'open("{CANARY}", "w")\'}}',
        "x: !!python/module:antigravity",
        f"a0: &a0 lol\n{laughs}",
        f"m0: &m0 {{k: v}}\n{merges}",
        "x: &x [*x]",
        "x: &x {y: *x}",
        "<<: *nowhere",
        "x: " + "[" * DEEP,
        "x: " + "{a: " * 5000 + "1" + "}" * 5000,
        "- a\n" * 3,
        "\tx: 1",
        "x: \x00",
        "%YAML 9.9\n---\n",
        "--- 1\n--- 2",
        "? [a, b]\n: 1",
        "x: !!binary 'AAAA'",
        "x: 2001-99-99",
        "x: !!timestamp '2001-99-99'",
        "x: !!int '1_'",
        "seed: " + "9" * 10_000,
        "seed: 0x" + "f" * 100_000,
        "x: |" + "\n  " + "a" * 1_000_000,
        "name: '" + "\u2028" * 50 + "'",
        "x: 1:30:99",
        "&a " * 1000,
    )
    line = draw.choice(lines).encode() + b"\n"
    if line.startswith((b"seed", b"name")) and draw.random() < 0.5:
        key = line.split(b":")[0] + b":"
        return b"".join(
            line if row.startswith(key) else row for row in data.splitlines(keepends=True)
        )
    return draw.choice((data + line, line + data, line))
