"""Tests of bench/tables.py: python3 bench/tables_test.py"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import parts_tables
import quality_tables
import tables

REPORT = {
    "commit": "abc1234", "machine": {"processor": "a processor", "processors": 2}, "command": "xrds bench network", "runs": 5,
    "devices": [{"driver": "a driver"}],
    "accuracies": [{"model": "m", "precision": "fp32", "engineError": {"relativeRms": 4e-7}}, {"model": "m", "precision": "fp16"}],
    "networks": [{"model": "m", "precision": precision, "multiplyAdds": 9e9, "attentionMultiplyAdds": 1e9, "kernelFamily": "lane",
                  "openSeconds": 0.25, "preparationSeconds": 1.0, "wallSeconds": {"median": seconds},
                  "memory": {"plannedBytes": 100e6, "weightBytes": 2e6}}
                 for precision, seconds in (("fp32", 0.5), ("fp16", 0.75))]}


def quality_report(scale, colour, aux, methods):
    """As `xrds bench quality --json` writes it, of one scene."""
    return {"device": "a device", "colourSamples": colour, "methods": [
        {"name": name, "mean": {"psnr": psnr, "relMse": 0.5, "relMseTrimmed": 0.25, "relMseMedian": 0.1, "flip": 0.125},
         **({"psnrToGuided": psnr - 20, "best": "s1", "worst": "s1"} if name != "guided" else {}),
         "scenes": {"s1": {"psnr": psnr, "relMse": 0.5, **({"psnrToGuided": psnr - 20} if name != "guided" else {})}}}
        for name, psnr in methods.items()]}


class Tables(unittest.TestCase):
    def test_a_row_has_work_time_memory_and_error(self):
        row = tables.network_table(REPORT).splitlines()[-1]
        self.assertEqual(row, "| `m` | 10.0 | 0.50 | 0.75 | 100 | 100 | 2.0 | 1.2 | 4.0e-07 | - |")

    def test_a_gpu_has_a_row_of_milliseconds(self):
        of_gpu = {**REPORT, "devices": [{"name": "a GPU", "driver": "a driver"}],
                  "networks": [{**REPORT["networks"][0], "deviceSeconds": {"median": 0.004}, "memory": {"deviceBytes": 5e6}}]}
        table = tables.gpu_tables.gpu_network(of_gpu)
        self.assertEqual(table.splitlines()[-1], "| `m` | 500.0 | 4.0 | 250 | 5 | 1.25 |")
        self.assertIn("commit abc1234, a GPU, driver a driver, 2 cores of an a processor, lane kernels", table)

    def test_commit_and_machine_stand_above(self):
        self.assertIn("commit abc1234, 2 cores of a processor, a driver, lane kernels, medians of 5 frames", tables.network_table(REPORT))

    def test_only_what_stands_between_the_marks_changes(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "network.json").write_text(json.dumps(REPORT))
            text = "before\n<!-- table network -->\nold\n<!-- end -->\nafter\n"
            new = tables.updated(text, pathlib.Path(folder))
            self.assertTrue(new.startswith("before\n<!-- table network -->\n`xrds") and new.endswith("<!-- end -->\nafter\n"))
            self.assertNotIn("old", new)
            self.assertEqual(tables.updated(new, pathlib.Path(folder)), new)

    def test_a_table_without_results_stays(self):
        with tempfile.TemporaryDirectory() as folder:
            text = "<!-- table quality_means -->\nold\n<!-- end -->\n"
            self.assertEqual(tables.updated(text, pathlib.Path(folder)), text)

    def test_skipping_and_tiles_have_a_row_for_each_case(self):
        report = lambda model, **found: {"version": "0", "processors": 2, "definitions": {}, "devices": [{"driver": "a driver"}],
                                         "folder": "here", "model": model, "precision": "fp32", "runs": 3, **found}
        stated = {"commit": "abc1234", "machine": {"processor": "a processor", "processors": 2}, "command": "xrds bench"}
        scene = {"name": "sky", "skipped": 0.5, "work": 0.75, "medianSecondsOff": 2.0, "medianSeconds": 1.0, "faster": 2.0, "psnrOff": 40.0,
                 "psnr": 40.25, "largestChange": {"skipped": 0.001, "others": 0.0005}}
        first, *_, row = parts_tables.skip_table({**stated, **parts_tables.together([report("xrds-x4-compact", scenes=[scene])])}).splitlines()
        self.assertEqual(first, "`xrds bench`, commit abc1234, 2 cores of a processor, a driver, fp32, medians of 3 pairs of runs:")
        self.assertEqual(row, "| x4-compact | sky | 50.0 % | 75.0 % | 2.000 | 1.000 | **2.00** | 40.000 | +0.2500 | 0.00100 | 0.00050 |")
        error = {"relativeRms": 0.01, "psnrChange": -0.125, "step": 2.5}
        halos = [{"halo": halo, "mean": error, "worst": error} for halo in (8, 16)]
        table = parts_tables.tiles_table({**stated, **parts_tables.together([report(model, halos=halos) for model in ("m", "n")])})
        self.assertEqual(table.splitlines()[-1], "| n | **16**, the default | 1.00e-02 | 1.00e-02 | -0.1250 | -0.1250 | 2.50 |")
        self.assertEqual(len(table.splitlines()), 8)

    def test_quality_is_gathered_with_its_origin_and_distances(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            write = lambda file, value: (folder / file).write_text(json.dumps(value))
            write("origin.json", {"commit": "abc1234", "machine": {"processor": "a processor", "processors": 2}})
            write("x4_64_aux16.json", quality_report(4, 64, 16, {"guided": 20.0, "xrds-x4-compact": 21.5}))
            write("x4_64_aux16.lpips.json", {"xrds-x4-compact": {"s1": 0.1, "s2": 0.2}})
            write("x4_64_aux16_merged.json", quality_report(4, 64, 16, {"guided": 20.5, "xrds-x4-compact": 22.5}))
            write("x4_64_aux16_merged_denoised.json", quality_report(4, 64, 16, {"xrds-x4-compact": 23.5, "xrds-x4-compact ensemble 8": 23.75}))
            write("x4_64_aux16_ensemble2.json", quality_report(4, 64, 16, {"xrds-x4-compact": 21.5, "xrds-x4-compact ensemble 2": 21.625}))
            write("x1_2_aux2.json", quality_report(1, 2, 2, {"guided": 20.0, "OIDN, prefiltered": 30.0}))
            write("oidn_prefiltered.lpips.json", {"oidn2": {"s1": 0.3}, "oidn4": {"s1": 0.4}})
            report = quality_tables.gather(folder)
        caption, _, _, _, *rows = quality_tables.means(report).splitlines()
        self.assertIn("commit abc1234, a device, 2 cores of a processor", caption)
        self.assertEqual(rows, ["| guided | 20.00 | - | 0.5000 | 0.2500 | 0.1250 | - | - |",
                                "| xrds-x4-compact | 21.50 | +1.50 | 0.5000 | 0.2500 | 0.1250 | 0.1500 | s1 +1.50 |"])
        self.assertEqual(quality_tables.scenes(report).splitlines()[-1], "| s1 | 20.00 / 0.5000 | 21.50 / 0.5000 |")
        self.assertIn("| xrds-x4-compact | - | - | 21.50 / 0.5000 / 0.1500 | - |", quality_tables.auxiliary(report))
        self.assertEqual(quality_tables.ensemble(report).splitlines()[4:],
                         ["| `xrds-x4-compact`, 64 spp | 21.500 / 0.5000 | 21.625 / 0.5000 |  |"])
        self.assertEqual(quality_tables.merged(report).splitlines()[4:],
                         ["| scale 4, 64 and 16 spp | xrds-x4-compact | 22.50 / 0.2500 | 23.50 / 0.2500 | 23.75 / 0.2500 |"])
        self.assertIn("| OIDN, prefiltered | 30.00 / 0.5000 / 0.3000 | - | - |", quality_tables.equal(report))

    def test_scale_1_of_a_later_run_stands_beside_the_rest(self):
        row = lambda name, psnr: {"name": name, "psnr": psnr, "relMse": 0.5}
        origin = {"machine": {"processor": "a processor", "processors": 2}, "command": "quality.sh", "device": "a device"}
        whole = {**origin, "commit": "abc1234", "settings": {"x1_2_aux2": [row("xrds-x1-compact", 28)], "x2_4_aux1": [row("xrds-x2-compact", 26)]}}
        later = {**origin, "commit": "def5678", "settings": {
            "x1_2_aux2": [row("guided", 20), row("OIDN", 29), row("xrds-x1-compact", 28.5)], "x1_2_aux2_denoised": [row("input", 29), row("xrds-x1-compact", 30)]}}
        report = quality_tables.with_single(whole, later)
        self.assertIn("commit abc1234 (scale 1: def5678)", quality_tables.single(report))
        self.assertEqual(quality_tables.single(report).splitlines()[4:], [
            "| OIDN | - | 29.00 / 0.5000 | - | - | - |", "| xrds-x1-compact | - | 28.50 / 0.5000 | - | - | - |",
            "| xrds-x1-compact, denoised first | - | 30.00 / 0.5000 | - | - | - |"])
        self.assertIn("| xrds-x2-compact | 26.00 / 0.5000 | - | - |", quality_tables.equal(report))

    def test_the_documents_are_those_of_the_measurements(self):
        self.assertEqual(subprocess.run([sys.executable, tables.__file__, "check"], capture_output=True, text=True).stderr, "")


if __name__ == "__main__":
    unittest.main()
