"""`python -m kernels`: build libraries of the kernels.

For this machine and for web pages by default, for all platforms with the word `all`, or for those
that are named. `python -m kernels cache` needs no linker: it compiles them for this machine, into
the folder where the first call of a kernel would keep it.
"""

import os
import sys


def main(names: list[str]) -> None:
    """Compile the faces of all kernels that Python calls, and link them for each platform."""
    if names == ["cache"]:
        from kernels.cache import compile_all as compile_for_this_machine

        compile_for_this_machine()
        return
    from kernels.build import TARGETS, build, build_material
    from kernels.entries import compile_all
    from thermobearing.core.compiled.native import FOLDER, library_name

    platforms = {target.name: target for target in TARGETS}
    unknown = [name for name in names if name not in {"all", *platforms}]
    if unknown:
        sys.exit(f"unknown platforms: {unknown}; known: {['all', *platforms]}")
    wanted = platforms if "all" in names else names or (library_name(), "wasm32")
    targets = [target for target in TARGETS if target.name in wanted]
    for_pages_only = all(target.suffix == "wasm" for target in targets)
    faces, described = compile_all(for_pages_only=for_pages_only)
    build(faces, described, FOLDER, targets)
    if any(target.name.startswith("linux-x86_64") for target in targets):
        build_material(FOLDER)


if __name__ == "__main__":
    os.environ["THERMOBEARING_KERNELS"] = "jit"
    main(sys.argv[1:])
