# SPDX-License-Identifier: BSD-3-Clause
"""Read a robot: a built-in one, one of ``robot_descriptions``, or any URDF, MJCF or xacro file."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import logging
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from softimpact.robots import built_in_robots

from ..errors import (
    InvalidInertia,
    InvalidValue,
    ModelFileError,
    UnknownName,
    UnsupportedModel,
)
from .assembly import Base, assemble
from .description import Description, require_finite
from .mjcf import read_mjcf
from .plausibility import implausible, require_sound_masses
from .robot import Robot
from .urdf import describe_urdf
from .welding import chain_to
from .xml_file import parsed, root_tag, text_of

SUFFIXES = (".urdf", ".xml", ".mjcf", ".xacro", ".sdf")
"""What names of robot files end with; what is in them decides."""

LOGGER = logging.getLogger(__name__)

FOLDERS_ABOVE = 4
"""Folders from a file up to its package's, ``urdf/robots/arm`` for example, and that one."""

JOINTS_TRIED = 200
"""Joints of a robot among which one is looked for whose chain has sound masses."""


def load_robot(
    model: str | Path,
    tip: str | None = None,
    *,
    floating: bool = False,
    hold_base: bool = False,
    toward: str | None = None,
) -> Robot:
    """Read a built-in robot, one of ``robot_descriptions``, or one from a URDF or MJCF file.

    What a file holds is told by its content. Every body and every site becomes a frame; a site
    that shares its name with a body is ``site:NAME``, and a body without a name goes by its
    number. The model's gravity is not kept. What changes the robot and is not read stands in the
    robot's ``warnings``. Of MJCF's ``custom`` elements the text ``tip`` names the contact frame,
    the numerics ``rotor_inertia:NAME`` hold sets of reflected rotor inertias, and the numeric
    ``speed_limit`` the joints' largest speeds; the text ``rotors`` with the value ``stated`` says
    that joints without armature have no rotor, or that rotors are bodies of their own. MJCF
    ``equality/connect`` closes a loop: ``home`` is then the first keyframe (or the model's
    reference configuration), and the custom text ``independent`` may name the joints whose
    coordinates describe the closed chain, separated by spaces.

    Inertias are judged where they count: over the joints on the way to the tip, each with all
    that is welded to it (here if there is a tip, else by ``chain_to``; a robot no chain of which
    can be is refused here).

    Args:
        model: name of a robot, or path of a file.
        tip: frame taken as the contact point where none is named; default the file's.
        floating: drop a free joint at the root; the root's frame is the base then.
            ``floating_robot`` frees the base of any robot, however its file attaches it.
        hold_base: hold a root that is free where the file has it.
        toward: a frame of the tree that is the robot, where a file has several and the tip does
            not tell; default the one with the most joints.

    Raises:
        ModelFileError: the file is missing, not readable, or holds no joint.
        InvalidInertia: an inertia is missing or impossible, where it counts.
        UnsupportedModel: the robot floats and neither ``floating`` nor ``hold_base`` is given, or
            the file holds what no model of ours is.
        FrameNotFound: the robot has no frame ``tip``.
    """
    if floating and hold_base:
        raise InvalidValue("hold_base", "excludes floating; give one of them")
    base: Base = "free" if floating else "held" if hold_base else "fixed"
    path = model_path(model)
    LOGGER.info("read %s", path)
    with np.errstate(all="ignore"):  # what is not finite is refused by its name
        description = describe(path)
    require_finite(description)
    chosen = tip or description.tip
    robot = assemble(description, toward or chosen, base)
    doubts = () if str(model) in built_in_robots() else implausible(robot)  # those cite sources
    robot = replace(robot, tip=chosen, warnings=(*robot.warnings, *doubts))
    if robot.tip is not None:
        robot.frame(robot.tip)
        chain_to(robot, robot.tip)
    elif not floating:
        _require_a_sound_chain(robot)
    return robot


def _require_a_sound_chain(robot: Robot) -> None:
    """Raise InvalidInertia if no chain of a robot has masses that can be."""
    try:
        require_sound_masses(robot)
    except InvalidInertia as found:
        for i in range(min(robot.n, JOINTS_TRIED)):
            name = next((f.name for f in robot.frames.values() if f.joint == i), None)
            with contextlib.suppress(InvalidInertia, UnsupportedModel):
                if name is not None:
                    chain_to(robot, name)
                    return
        raise found from None


def describe(path: Path) -> Description:
    """Read a file of any format; raises what ``load_robot`` does."""
    text = text_of(path)
    root = root_tag(text)
    if root == "robot":
        if path.suffix.lower() == ".xacro" or "<xacro:" in text:
            text = _expanded(path)
        return describe_urdf(parsed(text, str(path)), str(path))
    if root == "sdf":
        raise ModelFileError(str(path), "is SDF; convert it to URDF or MJCF")
    return read_mjcf(path)


def _expanded(path: Path) -> str:
    """Return the URDF that a xacro file describes.

    ``$(find PACKAGE)`` looks near the file first, then where ROS does; files of visuals are left
    alone.
    """
    try:
        importlib.import_module("xacrodoc")
        packages = importlib.import_module("xacrodoc.packages")
        xacro = importlib.import_module("xacro")
    except ImportError:
        raise ModelFileError(
            str(path),
            "is xacro: install xacrodoc (pip install xacrodoc), or expand it with "
            "'xacro FILE > robot.urdf'",
        ) from None
    try:
        packages.reset()  # it keeps what it found for the file before
        packages.walk_up_from(str(path))
        packages.update_package_cache(_folders_near(path))
        return str(xacro.process_file(str(path.resolve())).toxml())
    except Exception as error:  # whatever xacro's macros run into
        words = " ".join(str(error).split()) or type(error).__name__
        said = re.sub(r"^(?:<class '[^']+'>: )?(.+) \1$", r"\1", words)  # xacro says it twice
        hint = "; put the package's folder beside the file's" if "ackage not found" in said else ""
        raise ModelFileError(str(path), f"xacro does not expand: {said}{hint}") from None


def _folders_near(path: Path) -> dict[str, Path]:
    """Folders above a file and beside these by their names, which are packages' by custom."""
    near: dict[str, Path] = {}
    for folder in reversed(path.resolve().parents[:FOLDERS_ABOVE]):
        with contextlib.suppress(OSError):  # one that may not be listed
            near |= {beside.name: beside for beside in folder.parent.iterdir() if beside.is_dir()}
    return near


def model_path(model: str | Path) -> Path:
    """Return the file of a robot by its name, or the path itself; raises UnknownName."""
    path = Path(model)
    known = built_in_robots()
    if str(model) in known:
        return known[str(model)]
    if path.suffix.lower() in SUFFIXES or path.is_file():
        return path
    described = _described(str(model))
    if described is not None:
        return described
    raise UnknownName("robot (neither built in nor a .urdf or .xml file)", str(model), known)


def _described(name: str) -> Path | None:
    """Return the file of a robot of the package ``robot_descriptions``, where it is installed."""
    if not name.isidentifier() or importlib.util.find_spec("robot_descriptions") is None:
        return None
    if importlib.util.find_spec(f"robot_descriptions.{name}") is None:
        return None
    try:
        module = importlib.import_module(f"robot_descriptions.{name}")
    except Exception as error:  # it clones repositories as it is imported
        words = " ".join(str(error).split()) or type(error).__name__
        raise ModelFileError(name, f"robot_descriptions cannot fetch it: {words}") from None
    for attribute in ("MJCF_PATH", "URDF_PATH", "XACRO_PATH"):
        if hasattr(module, attribute):
            return Path(getattr(module, attribute))
    return None
