"""``febkit convert`` on inputs and meshes."""

from pathlib import Path

from click.testing import CliRunner

from febkit.cli.convert import command
from febkit.feb import diff, read

DATA = Path(__file__).parent / "data"
V4 = DATA / "two_blocks_40.feb"


def run(*args):
    return CliRunner().invoke(command, [str(a) for a in args])


def test_down_and_up(tmp_path):
    for version in ("3.0", "2.5"):
        done = run(V4, tmp_path / "old.feb", "--to", version, "--force")
        assert done.exit_code == 0 and f"(febio_spec {version}, 0 notes)" in done.output
        assert read(tmp_path / "old.feb").version == version
        assert run(tmp_path / "old.feb", tmp_path / "new.feb", "--force").exit_code == 0
        assert diff(read(V4), read(tmp_path / "new.feb")) == []


def test_losses_are_printed_and_refused_when_asked(tmp_path):
    text = V4.read_text().replace('<Module type="solid"/>', '<Module type="solid"><units>SI</units></Module>')
    (tmp_path / "m.feb").write_text(text)
    done = run(tmp_path / "m.feb", tmp_path / "old.feb", "--to", "2.5")
    assert done.exit_code == 0 and "not said in version 2.5: <Module><units>" in done.output
    (tmp_path / "old.feb").unlink()
    done = run(tmp_path / "m.feb", tmp_path / "old.feb", "--to", "2.5", "--strict")
    assert done.exit_code == 1 and not (tmp_path / "old.feb").exists()


def test_to_a_mesh_and_back(tmp_path):
    assert run(V4, tmp_path / "m.vtu").exit_code == 0
    assert run(tmp_path / "m.vtu", tmp_path / "m.feb").exit_code == 0
    m = read(tmp_path / "m.feb")
    assert len(m.mesh.node_ids) == 12 and sum(len(b.ids) for b in m.mesh.blocks) == 2 and m.materials
