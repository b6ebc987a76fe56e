"""Files of results of every version are read, and a damaged one is never taken for whole."""

import logging
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest

import fem_lie as fl

DATA = Path(__file__).parent / "data"
VERSIONS = sorted(DATA.glob("results_*.h5"))
GRAVITY, STEP, DURATION = 9.81, 0.05, 0.5


def falling_ball() -> fl.Scene:
    """A ball that falls 1 m onto a floor, beside a beam on a hinge."""
    ball = fl.RigidBody(mass=2.0, inertia=(0.01, 0.01, 0.01), position=(0, 3, 1.1), name="ball")
    material = fl.Material(2e9, 0.3, 1000.0)
    section = fl.Section.rectangle(0.1, 0.1, material)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2, name="beam")
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(ball)
    scene.add(beam)
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0), name="hinge"))
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1), floor, fl.contact.Impact(restitution=0.8)
        )
    )
    return scene


SCHEME = fl.GeneralisedAlpha()


def run(file: Path | None = None) -> fl.Result:
    """The run of which ``tests/data`` has a file of each version."""
    options = {} if file is None else {"file": file, "checkpoint_every": 4}
    return SCHEME.run(falling_ball(), duration=DURATION, step=STEP, progress=False, **options)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A file of results of today, its checkpoints, and the result."""
    file = tmp_path_factory.mktemp("written") / "run.h5"
    return file, run(file)


def same(found: fl.Result, wanted: fl.Result) -> None:
    """All arrays, names and numbers but the seconds."""
    for name in ("times", "frames", "velocities", "kinetic", "joint_forces", "iterations"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name), err_msg=name)
    np.testing.assert_array_equal(found.contacts.each, wanted.contacts.each)
    assert [body.name for body in found.info.bodies] == [body.name for body in wanted.info.bodies]
    assert found.info.joints[0].coordinates == wanted.info.joints[0].coordinates
    assert found.info.mass == wanted.info.mass
    assert found.factorisations == wanted.factorisations


@pytest.mark.parametrize("file", [pytest.param(file, id=file.stem) for file in VERSIONS])
def test_each_version_is_read(file):
    """A ball falls by g t²/2; the rest as another version has it."""
    result = fl.Result.load(file)
    np.testing.assert_allclose(result.times, STEP * np.arange(11), rtol=1e-14)
    free = result.times < np.sqrt(2 / GRAVITY)
    height = result.frames[free, 0, 0, 2]
    np.testing.assert_allclose(height, 1.1 - 0.5 * GRAVITY * result.times[free] ** 2, rtol=1e-12)
    assert result.info.mass == pytest.approx(12.0)
    assert [body.name for body in result.info.bodies] == ["ball", "beam"]
    assert result.info.joints[0].coordinates == ("angle",)
    assert len(result.contacts.each) == 1
    same(result, fl.Result.load(VERSIONS[0]))


@pytest.mark.parametrize("file", [pytest.param(file, id=file.stem) for file in VERSIONS])
def test_displacements_need_the_undeformed_configuration(file, tmp_path):
    """It is in files since version 12; earlier ones say so instead of taking the first state."""
    result = fl.Result.load(file)
    if int(file.stem.rpartition("_")[2]) >= 12:
        fallen = result.position("ball.centre") - [0, 3, 1.1]
        np.testing.assert_allclose(result.displacement("ball.centre"), fallen, atol=1e-15)
        return
    for ask in (
        lambda: result.displacement("ball.centre"),
        lambda: result.write_vtk(tmp_path / "run.pvd"),
    ):
        with pytest.raises(ValueError, match="'ball' has no recorded undeformed configuration"):
            ask()


def test_there_is_a_file_of_every_version(written, tmp_path):
    """Who writes another version leaves a file of it here, with the motion of the others.

    ``Result(**vars(Result.load(DATA / "results_11.h5")) | {"info": run().info}).save(...)``.
    """
    import h5py

    file, result = written
    result.save(tmp_path / "saved.h5")
    for newest in (file, tmp_path / "saved.h5"):
        with h5py.File(newest) as found:
            version = found.attrs["version"]
        numbers = sorted(int(one.stem.rpartition("_")[2]) for one in VERSIONS)
        assert numbers == [*range(10, version + 1)]
    with h5py.File(tmp_path / "saved.h5", "r+") as found:
        found.attrs["version"] = 9
    with pytest.raises(ValueError, match=rf"results of versions 10 to {version}: .*version 9"):
        fl.Result.load(tmp_path / "saved.h5")


def test_a_file_of_another_version_is_not_resumed(written, tmp_path):
    file, _ = written
    old = tmp_path / "run.h5"
    old.write_bytes((DATA / "results_10.h5").read_bytes())
    (tmp_path / "run.h5.checkpoint").write_bytes(file.with_name("run.h5.checkpoint").read_bytes())
    with pytest.raises(ValueError, match=r"of version 10, and rows can only be added to version"):
        SCHEME.resume(falling_ball(), old, progress=False)
    fl.Result.load(old)


def flipped(data: bytes, at: int, bit: int) -> bytes:
    return data[:at] + bytes([data[at] ^ (1 << bit)]) + data[at + 1 :]


@pytest.mark.parametrize("how", ["run", "saved"])
def test_a_flipped_bit_is_an_error_or_changes_nothing(written, tmp_path, how):
    """Parts of a file that nobody reads may change."""
    file, result = written
    if how == "saved":
        file = tmp_path / "saved.h5"
        result.save(file)
    whole, damaged, named = file.read_bytes(), tmp_path / "damaged.h5", 0
    rng = np.random.default_rng(7)
    for at in rng.integers(len(whole), size=300):
        damaged.write_bytes(flipped(whole, int(at), int(rng.integers(8))))
        try:
            found = fl.Result.load(damaged)
        except ValueError as error:
            assert "damaged.h5' is " in str(error)
            named += 1
        else:
            same(found, result)
    assert named


@pytest.mark.parametrize("array", ["frames", "times", "iterations", "kinetic"])
def test_a_flipped_bit_in_a_row_is_named(written, tmp_path, array):
    import h5py

    file, _ = written
    damaged = tmp_path / "damaged.h5"
    with h5py.File(file) as found:
        item = found[array]
        at = item.id.get_offset() + 3 * item.dtype.itemsize * item[0].size
    damaged.write_bytes(flipped(file.read_bytes(), at, 0))
    with pytest.raises(ValueError, match=r"damaged: 1 of 11 rows do not agree .* is row 3"):
        fl.Result.load(damaged)


def checkpoints(file: Path) -> tuple[Path, Path]:
    """The last checkpoint, and the one before."""
    last = file.with_name(file.name + ".checkpoint")
    return last, last.with_name(last.name + ".before")


@pytest.fixture
def interrupted(written, tmp_path):
    """Files of a run that ended after its second checkpoint, and the whole result."""
    file, result = written
    for path in (file, *checkpoints(file)):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    return tmp_path / file.name, result


def flipped_in_an_array(data: bytes) -> bytes:
    """A bit in the largest array: parts of a file that nobody reads may change."""
    with ZipFile(BytesIO(data)) as file:
        largest = max(file.infolist(), key=lambda info: info.compress_size)
    # behind its header of 30 bytes, its name and the header of numpy, up to the next one
    return flipped(data, largest.header_offset + largest.compress_size // 2 + 100, 4)


DAMAGES = {
    "cut": lambda data: data[: len(data) // 2],
    "empty": lambda data: b"",
    "flipped": flipped_in_an_array,
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_the_checkpoint_before_a_damaged_one_is_used(interrupted, caplog, damage):
    file, whole = interrupted
    last, before = checkpoints(file)
    last.write_bytes(DAMAGES[damage](last.read_bytes()))
    with caplog.at_level(logging.WARNING, logger="fem_lie"):
        same(SCHEME.resume(falling_ball(), file, progress=False), whole)
    assert f"'{last}' is damaged" in caplog.text and f"resumes from {before}" in caplog.text


def test_a_missing_checkpoint_is_replaced_by_the_one_before(interrupted):
    """As after an end between the renaming of the two."""
    file, whole = interrupted
    checkpoints(file)[0].unlink()
    same(SCHEME.resume(falling_ball(), file, progress=False), whole)


def test_damaged_checkpoints_are_named(interrupted):
    file, _ = interrupted
    for path in checkpoints(file):
        path.write_bytes(path.read_bytes()[:1000])
    with pytest.raises(
        ValueError, match=r"cannot resume: .*checkpoint' is damaged .* and .*before"
    ):
        SCHEME.resume(falling_ball(), file, progress=False)


def test_a_flipped_bit_in_a_checkpoint_is_noticed_or_changes_nothing(interrupted):
    file, wanted = interrupted
    last, before = checkpoints(file)
    before.unlink()
    results, whole = file.read_bytes(), last.read_bytes()
    rng, noticed = np.random.default_rng(3), 0
    for at in rng.integers(len(whole), size=80):
        file.write_bytes(results)
        last.write_bytes(flipped(whole, int(at), int(rng.integers(8))))
        try:
            found = SCHEME.resume(falling_ball(), file, progress=False)
        except ValueError as error:
            assert f"'{last}' is damaged" in str(error)
            noticed += 1
        else:
            same(found, wanted)
            before.unlink(missing_ok=True)
    assert noticed


def test_a_new_run_removes_checkpoints_of_an_older_one(interrupted):
    file, _ = interrupted
    SCHEME.run(falling_ball(), duration=STEP, step=STEP, file=file, progress=False)
    last, before = checkpoints(file)
    assert last.exists() and not before.exists()
