"""Imports MuJoCo, whatever MUJOCO_GL says."""

import os


def import_mujoco() -> None:
    """Import MuJoCo for the first time.

    Its package imports the picture library that MUJOCO_GL names, and fails where there is none:
    physics needs no pictures. Who asks for one is told what is wrong (`pictures`).
    """
    try:
        import mujoco
    except Exception:  # each library fails with errors of its own
        library = os.environ.get("MUJOCO_GL")
        if library is None:
            raise
        os.environ["MUJOCO_GL"] = "disable"
        try:
            import mujoco  # noqa: F401
        finally:
            os.environ["MUJOCO_GL"] = library
