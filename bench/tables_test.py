"""Tests of bench/tables.py: python3 bench/tables_test.py"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import tables

REPORT = {
    "commit": "abc1234", "machine": {"processor": "a processor", "processors": 2}, "command": "xrds bench network", "runs": 5,
    "devices": [{"driver": "a driver"}],
    "accuracies": [{"model": "m", "precision": "fp32", "engineError": {"relativeRms": 4e-7}}, {"model": "m", "precision": "fp16"}],
    "networks": [{"model": "m", "precision": precision, "multiplyAdds": 9e9, "attentionMultiplyAdds": 1e9, "kernelFamily": "lane",
                  "openSeconds": 0.25, "preparationSeconds": 1.0, "wallSeconds": {"median": seconds},
                  "memory": {"plannedBytes": 100e6, "weightBytes": 2e6}}
                 for precision, seconds in (("fp32", 0.5), ("fp16", 0.75))]}


class Tables(unittest.TestCase):
    def test_a_row_has_work_time_memory_and_error(self):
        row = tables.network_table(REPORT).splitlines()[-1]
        self.assertEqual(row, "| `m` | 10.0 | 0.50 | 0.75 | 100 | 100 | 2.0 | 1.2 | 4.0e-07 | - |")

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

    def test_the_documents_are_those_of_the_measurements(self):
        self.assertEqual(subprocess.run([sys.executable, tables.__file__, "check"], capture_output=True, text=True).stderr, "")


if __name__ == "__main__":
    unittest.main()
