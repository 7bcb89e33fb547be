"""Where a LeRobot v3 data set keeps what: file names, keys and features."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from prime_core.contracts.description import SceneDescription
from prime_core.contracts.environment import ACTION_NAMES, CONTROL_FREQUENCY
from prime_core.contracts.observations import ENVIRONMENT_STATE_KEY, IMAGE_PREFIX, STATE_KEY

CODEBASE_VERSION = "v3.0"


INFO_FILE = "meta/info.json"


STATISTICS_FILE = "meta/stats.json"


TASKS_FILE = "meta/tasks.parquet"


EPISODES_FOLDER = "meta/episodes"


EPISODES_FILE = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


DATA_FILE = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


VIDEO_FILE = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"


IMAGE_FILE = "frame-{frame_index:06d}.png"
"""The name that an image which lies in a data file goes by."""


# Ours. LeRobot writes info.json anew when a data set grows and drops the keys that it does not
# know, so what it need not know has files of its own.
PRIME_FILE = "meta/prime.json"


PRIMITIVES_FILE = "meta/primitives.parquet"


ACTION_KEY = "action"


SIMULATOR_STATE_KEY = "simulator_state"


PRIMITIVE_INDEX_KEY = "primitive_index"


MOTION_KEY = "language_persistent"


CHUNK_SIZE = 1000
"""Most files of one chunk folder."""


DATA_FILE_MEGABYTES = 100
"""Size at which LeRobot begins another data file."""


VIDEO_FILE_MEGABYTES = 200
"""Size at which LeRobot begins another video file."""


ENCODER = "libsvtav1"
"""LeRobot's of videos."""


ENCODER_OPTIONS = {"g": 2, "crf": 30, "preset": 12}
"""LeRobot's: one of so many frames stands alone, quality (0 is best), speed."""


PIXEL_FORMAT = "yuv420p"
"""LeRobot's; it halves the resolution of colour."""


BOOKKEEPING = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
"""The columns that every LeRobot data set has, and their types."""


@dataclass(frozen=True)
class Contents:
    """What a data set holds beside states and actions.

    Attributes:
        simulator_state_width: Length of the simulator states; 0 where there are none.
        images: Height, width and 3, by camera.
        videos: Whether images are frames of videos.
        segments: Whether the demonstrations are parsed.
        motion_rows: Whether the segments are also given in LeRobot's own way.
    """

    simulator_state_width: int = 0
    images: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    videos: bool = False
    segments: bool = False
    motion_rows: bool = False


def features_of(description: SceneDescription, contents: Contents) -> dict[str, Any]:
    """Return the table of features of ``meta/info.json``."""
    result = {
        STATE_KEY: _feature("float32", description.state_width, description.state_names),
        ENVIRONMENT_STATE_KEY: _feature(
            "float32", description.environment_state_width, description.environment_state_names
        ),
        ACTION_KEY: _feature("float32", len(ACTION_NAMES), list(ACTION_NAMES)),
        SIMULATOR_STATE_KEY: _feature("float64", contents.simulator_state_width),
    }
    # LeRobot cannot read a feature without numbers: a scene without objects has no such column.
    result = {key: feature for key, feature in result.items() if feature["shape"] != [0]}
    for name, shape in contents.images.items():
        sides = ["height", "width", "channels"]
        kind = "video" if contents.videos else "image"
        result[IMAGE_PREFIX + name] = {"dtype": kind, "shape": [*shape], "names": sides}
        if contents.videos:
            result[IMAGE_PREFIX + name]["info"] = video_info(*shape[:2])
    result |= segment_features(contents.motion_rows) if contents.segments else {}
    return result | {key: _feature(kind, 1) for key, kind in BOOKKEEPING.items()}


def segment_features(motion_rows: bool = True) -> dict[str, Any]:
    """Return the features of a data set's segments."""
    result = {PRIMITIVE_INDEX_KEY: _feature("int64", 1)}
    if motion_rows:
        result[MOTION_KEY] = _feature("language", 1)
    return result


def video_info(height: int, width: int) -> dict[str, Any]:
    """Return what LeRobot notes of a video, with the settings that it encodes by."""
    info: dict[str, Any] = {"height": height, "width": width, "codec": "av1"}
    info |= {"pix_fmt": PIXEL_FORMAT, "fps": CONTROL_FREQUENCY, "channels": 3}
    info |= {**ENCODER_OPTIONS, "fast_decode": 0, "extra_options": {}, "video_backend": "pyav"}
    named = {f"video.{name}": value for name, value in info.items()}
    return {**named, "has_audio": False, "is_depth_map": False}


def _feature(kind: str, width: int, names: list[str] | None = None) -> dict[str, Any]:
    return {"dtype": kind, "shape": [width], "names": names}
