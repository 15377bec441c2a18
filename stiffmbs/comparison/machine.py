"""Machine and package versions of measured times."""

from __future__ import annotations

import os
import platform

PACKAGES = ("stiffmbs", "numpy", "scipy", "numba", "scikit-sundae", "exudyn", "casadi")


def machine() -> dict[str, object]:
    """Return the processor, the system, and versions of packages."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": platform.system(),
        "python": platform.python_version(),
        **{package: found for package in PACKAGES if (found := installed(package))},
    }


def machine_sentence() -> str:
    """Return the machine and versions in one line."""
    return ", ".join(f"{name} {value}" for name, value in machine().items())


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()


def installed(package: str) -> str | None:
    """Return the version of an installed package, or None."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return None
