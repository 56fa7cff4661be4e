"""Installs the faulty plugins into a folder, as a package that this process and others find."""

import shutil
from pathlib import Path

HERE = Path(__file__).parent


def install(folder: Path) -> Path:
    """Write the package with its entry points into a folder, which then belongs on the path."""
    capabilities = {
        "segmentation": "FaultySegmenter",
        "surveying": "FaultySurvey",
        "alignment": "FaultyAligner",
        "registration": "FaultyRegistrar",
        "motion": "FaultyMotion",
        "grasping": "FaultyGrasps",
        "placing": "FaultyPlaces",
    }
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(HERE / "faulty_plugins.py", folder)
    info = folder / "faulty.egg-info"
    info.mkdir(exist_ok=True)
    (info / "PKG-INFO").write_text("Name: faulty\nVersion: 1\n", encoding="utf-8")
    groups = [
        f"[executive.{capability}.v1]\nfaulty = faulty_plugins:{name}\n"
        for capability, name in capabilities.items()
    ]
    (info / "entry_points.txt").write_text("\n".join(groups), encoding="utf-8")
    return folder
