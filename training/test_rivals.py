"""The comparison of networks with equal trainings, on tiny scenes."""
import json
import math

import pytest
import torch

import rivals
import shards
from test_dataset import encoded, write_scene
from test_train import folders, run  # noqa: F401


@pytest.mark.parametrize("name", rivals.CONFIGS)
def test_networks_are_of_one_size(name):
    assert 70 < rivals.giga(rivals.CONFIGS[name]) < 100


def test_all_make_radiance_of_the_same_crops(tmp_path):
    write_scene(tmp_path, "s0000", side=64)
    shards.write_shard(tmp_path / "scenes-000.npz", encoded(tmp_path, "s0000"), 1e9)
    scenes = rivals.dataset.Scenes([tmp_path], rivals.SCENES)
    for config in rivals.CONFIGS.values():
        batch = rivals.Crops(scenes, 8, seed=3).batch(1)
        with torch.no_grad():
            result, target = rivals.forward(rivals.network_of(config, 1), batch, "float32")
        assert result.shape == target.shape == (1, 3, 32, 32) and result.isfinite().all() and (result >= 0).all()
        assert torch.equal(target, batch["exposure"] * batch["target"])


def test_what_is_finished_is_not_trained_again(folders, monkeypatch, tmp_path, capsys):     # noqa: F811
    scenes, packed, _ = folders
    monkeypatch.setattr(rivals, "CROP", 8)
    arguments = [packed, "--validation", scenes, "--output", tmp_path / "out", "--steps", 1, "--seeds", 1, 2, "--only", "EDSR", "MSSPL"]
    run(monkeypatch, rivals, *arguments)
    rows = json.loads((tmp_path / "out" / "results.json").read_text())
    assert [(row["name"], row["seed"]) for row in rows] == [("EDSR", 1), ("MSSPL", 1), ("EDSR", 2), ("MSSPL", 2)]
    assert all(math.isfinite(row["psnr"]) for row in rows) and len({row["psnr"] for row in rows}) == 4
    table = capsys.readouterr().out.splitlines()[-2:]
    assert table[0].startswith("| EDSR | colour |") and table[1].startswith("| MSSPL | colour, albedo, normal |")
    monkeypatch.setattr(rivals, "trained", lambda *_: pytest.fail("trained again"))
    run(monkeypatch, rivals, *arguments)
