"""Every public name with its signature, as text; run it to write the snapshot anew.

python tests/support/public_names.py > tests/house/public_names.txt
"""

import inspect
from types import ModuleType

import fpsolve as fp


def snapshot():
    """One line for every name that a user can reach, in order."""
    lines = [line for name in fp.__all__ for line in described(f"fp.{name}", name)]
    for package in ("paths", "plotting", "studies", "interop"):
        home = getattr(fp, package)
        for name in home.__all__:
            lines += entry(f"fp.{package}.{name}", getattr(home, name))
    return lines


def described(path, name):
    value = getattr(fp, name)
    if not isinstance(value, ModuleType):
        return entry(path, value)
    if hasattr(value, "__path__"):
        return [path]
    own = [(one, getattr(value, one)) for one in getattr(value, "__all__", [])]
    return [path, *(line for one, it in own for line in entry(f"{path}.{one}", it))]


def entry(path, value):
    """The line of a function; of a class one for every public member as well."""
    if not inspect.isclass(value):
        return [f"{path}{signature(value)}" if callable(value) else path]
    lines = [f"{path}{signature(value)}"]
    for name, member in sorted(members(value).items()):
        member = getattr(member, "__func__", member)
        kind = signature(member) if inspect.isfunction(member) else ""
        lines.append(f"{path}.{name}{kind}")
    return lines


def members(kind):
    """What a class and its bases of this package define, without what is private."""
    found = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("fpsolve"):
            found |= {
                name: value
                for name, value in vars(base).items()
                if not name.startswith("_")
            }
    return found


def signature(value):
    """The arguments with their defaults; annotations may change their place."""
    try:
        known = inspect.signature(value)
    except ValueError:
        return ""
    bare = [
        one.replace(annotation=inspect.Parameter.empty)
        for one in known.parameters.values()
    ]
    return str(
        known.replace(parameters=bare, return_annotation=inspect.Signature.empty)
    )


if __name__ == "__main__":
    print("\n".join(snapshot()))
