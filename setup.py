"""The import names of the folders: `plugins/` is installed as `executive_plugins`, and so on.

Nobody else's `plugins` or `trees` can then stand in the way, and ours stand in nobody's. All other
facts about the package are in pyproject.toml.
"""

from setuptools import find_packages, setup

FOLDERS = {
    "executive": "executive",
    "executive_plugins": "plugins",
    "executive_robot_models": "robot_models",
    "executive_trees": "trees",
}

setup(
    package_dir=FOLDERS,
    packages=[
        ".".join([name, *inner])
        for name, folder in FOLDERS.items()
        for inner in [(), *((package,) for package in find_packages(folder))]
    ],
)
