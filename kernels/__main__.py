"""`python -m kernels`: build the libraries of the kernels for all platforms, or those named."""

import os
import sys

# The processor that numba optimizes for, whatever builds; each object is then made for its own.
PROCESSOR = {
    "NUMBA_CPU_NAME": "x86-64-v3",
    "NUMBA_CPU_FEATURES": (
        "+avx,+avx2,+bmi,+bmi2,+cmov,+crc32,+cx16,+cx8,+f16c,+fma,+fxsr,+lzcnt,+mmx,+movbe,"
        "+popcnt,+sahf,+sse,+sse2,+sse3,+sse4.1,+sse4.2,+ssse3,+x87,+xsave"
    ),
}


def main(names: list[str]) -> None:
    """Compile the faces of all kernels that Python calls, and link them for each platform."""
    from kernels.build import TARGETS, build, build_material
    from kernels.entries import compile_all
    from thermobearing.core.compiled.native import FOLDER

    targets = [one for one in TARGETS if not names or one.name in names]
    faces, described = compile_all(all_of_them=any(one.suffix != "wasm" for one in targets))
    build(faces, described, FOLDER, targets)
    if any(target.name.startswith("linux-x86_64") for target in targets):
        build_material(FOLDER)


if __name__ == "__main__":
    os.environ |= PROCESSOR  # before numba is imported
    os.environ["THERMOBEARING_KERNELS"] = "jit"
    main(sys.argv[1:])
