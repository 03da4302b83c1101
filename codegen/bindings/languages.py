# SPDX-License-Identifier: BSD-3-Clause
"""What calls a package from C++ and Rust, made of what its header declares."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from functools import partial
from typing import Any

from .interface import CVariable, Entry, Interface

CPP_KEYWORDS = frozenset((
    "alignas", "alignof", "and", "asm", "auto", "bitand", "bitor", "bool", "break", "case",
    "catch", "char", "class", "compl", "concept", "const", "consteval", "constexpr",
    "constinit", "continue", "decltype", "default", "delete", "do", "double", "else", "enum",
    "explicit", "export", "extern", "false", "for", "friend", "goto", "if", "inline", "int",
    "long", "mutable", "namespace", "new", "noexcept", "not", "nullptr", "operator", "or",
    "private", "protected", "public", "register", "requires", "return", "short", "signed",
    "sizeof", "static", "struct", "switch", "template", "this", "throw", "true", "try",
    "typedef", "typeid", "typename", "union", "unsigned", "using", "virtual", "void",
    "volatile", "while", "xor", "std",
))  # fmt: skip
"""What no namespace can be called; words with an underscore are left out."""

C_FUNCTIONS = frozenset((
    "abort", "abs", "acos", "asctime", "asin", "atan", "atexit", "atof", "atoi", "atol",
    "bsearch", "calloc", "cbrt", "ceil", "clock", "copysign", "cos", "cosh", "ctime", "difftime",
    "div", "environ", "erf", "erfc", "exit", "exp", "fabs", "fdim", "floor", "fma", "fmax",
    "fmin", "fmod", "fopen", "free", "frexp", "getc", "getchar", "getenv", "gets", "gmtime",
    "hypot", "labs", "ldexp", "ldiv", "lgamma", "localtime", "log", "lrint", "lround", "main",
    "malloc", "memchr", "memcmp", "memcpy", "memmove", "memset", "mktime", "modf", "nan",
    "nearbyint", "pow", "printf", "putc", "putchar", "puts", "qsort", "raise", "rand", "realloc",
    "remainder", "remove", "remquo", "rename", "rewind", "rint", "round", "scanf", "signal",
    "sin", "sinh", "sqrt", "srand", "strcat", "strchr", "strcmp", "strcpy", "strlen", "strstr",
    "strtod", "strtol", "system", "tan", "tanh", "tgamma", "time", "trunc", "ungetc", "accept",
    "access", "alarm", "bind", "close", "connect", "daemon", "dup", "fork", "index", "kill",
    "link", "listen", "mount", "nice", "open", "pause", "pipe", "poll", "random", "read", "recv",
    "select", "send", "shutdown", "sleep", "stat", "sync", "write",
))  # fmt: skip
"""What C and POSIX declare outside of any namespace and a robot may be called."""

RUST = {
    "int": "c_int",
    "unsigned int": "c_uint",
    "unsigned char": "c_uchar",
}
RUST_KEYWORDS = frozenset(("in", "fn", "type", "ref", "self", "mod", "use", "impl", "move", "loop"))


def bindings(interface: Interface, show: Callable[..., str]) -> dict[str, str]:
    """Return a header for C++ and a crate for Rust, by their paths."""
    name = interface.prefix
    crate = f"{name.replace('_', '-')}-sys"
    words = {
        "interface": interface,
        "rust": partial(_rust, name),
        "pointer": partial(_rust_argument, name),
        "field": lambda v: f"r#{v.name}" if v.name in RUST_KEYWORDS else v.name,
    }
    return {
        f"include/{name}.hpp": show("header.hpp", **_cpp(interface)),
        "rust/Cargo.toml": show("rust/Cargo.toml", crate=crate),
        "rust/build.rs": show("rust/build.rs"),
        "rust/lib.rs": show("rust/lib.rs", **words),
    }


def _cpp(interface: Interface) -> dict[str, Any]:
    name = interface.prefix
    functions = [_cpp_function(name, e) for e in interface.entries.values() if _is_wrapped(e)]
    shown = next(f for f in reversed(functions) if f["name"] in ("safe_speed", "reflected_mass"))
    return {
        "namespace": f"{name}_" if name in CPP_KEYWORDS | C_FUNCTIONS else name,
        "functions": functions,
        "params": "params" in interface.structs,
        "region": "body_region" in interface.entries,
        "bounded": "region" in interface.structs,
        "shown": shown,
    }


def _is_wrapped(entry: Entry) -> bool:
    """Whether a function has one result and reads arrays of known size."""
    written = [a for a in entry.arguments if a.written]
    reads = bool(entry.arguments) and entry.arguments[0].name == "q"
    return reads and len(written) == 1 and all(None not in a.shape for a in entry.arguments)


def _cpp_function(name: str, entry: Entry) -> dict[str, Any]:
    """Return what the template shows of a function."""
    read = [a for a in entry.arguments if not a.written]
    (out,) = [a for a in entry.arguments if a.written]
    shape = [size or 1 for size in out.shape]
    kinds = {
        0: out.type if out.type in (*RUST, "real") else f"{name}_{out.type}",
        1: f"vector<{shape[0] if shape else 0}>",
        2: f"matrix<{', '.join(map(str, shape))}>",
    }
    return {
        "name": entry.name,
        "comment": [line for text in entry.comment.split("\n") for line in textwrap.wrap(text, 96)],
        "type": kinds[len(shape)],
        "array": len(shape) == 1,
        "matrix": shape if len(shape) == 2 else None,
        "arguments": [_cpp_argument(name, a) for a in read],
        "passed": [f"{a.name}.data()" if a.shape else f"&{a.name}" if a.pointer else a.name
                   for a in read],
        "call": ", ".join(a.name for a in read),
    }  # fmt: skip


def _cpp_argument(name: str, a: CVariable) -> str:
    if a.shape:
        return f"const vector<{a.shape[0]}> &{a.name}"
    kind = "real" if a.type == "real" else a.type if not a.pointer else f"{name}_{a.type}"
    return f"const {kind} &{a.name}" if a.pointer else f"{kind} {a.name}"


def _rust(name: str, v: CVariable) -> str:
    """Return a variable's type."""
    kind = RUST.get(v.type, f"{name}_{v.type}")
    for size in reversed(v.shape):
        kind = f"[{kind}; {size}]"
    return f"*const {kind}" if v.pointer else kind


def _rust_argument(name: str, a: CVariable) -> str:
    """Return an argument's type: a pointer to the first of several, as C has it."""
    kind = RUST.get(a.type, f"{name}_{a.type}")
    for size in reversed(a.shape[1:]):
        kind = f"[{kind}; {size}]"
    if not a.pointer:
        return kind
    return f"*{'mut' if a.written else 'const'} {kind}"
