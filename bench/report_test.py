"""Tests report.py on made-up measurements: python3 bench/report_test.py"""
import html.parser
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import report

HERE = pathlib.Path(__file__).parent


def network(model, precision, side, seconds):
    row = {"device": "u1", "model": model, "scale": 4, "precision": precision, "width": side, "height": side,
           "memory": {"plannedBytes": 4e6 * side, "lowerBoundBytes": 3e6 * side, "unaliasedBytes": 9e6 * side}}
    if seconds is None:
        return row | {"refused": "The frame needs <much> memory, more than the device can bind."}
    spread = {"median": seconds, "least": 0.9 * seconds, "most": 1.1 * seconds}
    row["memory"] |= {"deviceBytes": 5e6 * side, "peakProcessBytes": 6e6 * side}
    kernels = [{"program": "linear_lane_f32", "dispatches": 2, "seconds": 0.7 * seconds, "multiplyAdds": 5, "bytes": 6},
               {"program": "box_mean_plain_f32", "dispatches": 1, "seconds": 0.2 * seconds, "multiplyAdds": 0, "bytes": 6}]
    return row | {"openSeconds": 0.01, "preparationSeconds": 1, "firstSeconds": 2, "wallSeconds": spread,
                  "deviceSeconds": spread, "kernels": kernels}


def accuracy(model, precision, error, rel_mse):
    row = {"device": "u1", "model": model, "scale": 4, "precision": precision,
           "engineError": {"relativeRms": error, "worstRelativeRms": 2 * error, "worstOperator": "out", "finite": True,
                           "withinBound": True}}
    if rel_mse is None:
        return row | {"imageErrorMissing": "no scene"}
    return row | {"imageError": {"psnr": 30, "relMse": rel_mse, "relMseTrimmed": rel_mse, "flip": 0.1, "scenes": 3}}


NETWORKS = {
    "version": "1", "runs": 3, "definitions": {"wallSeconds": "seconds < minutes"},
    "devices": [{"name": "a <device>", "kind": "cpu", "driver": "d", "apiVersion": "1.3", "uuid": "u1", "memoryBytes": 1}],
    "networks": [network("xrds-fast", "fp32", 64, 0.01), network("xrds-slow", "fp16", 64, 0.1),
                 network("xrds-fast", "fp32", 128, 0.04), network("xrds-slow", "fp16", 128, None)],
    "accuracies": [accuracy("xrds-fast", "fp32", 1e-7, 0.02), accuracy("xrds-slow", "fp16", 1e-4, None)],
}


def operator(name, **more):
    row = {"name": name + "/manual_time", "run_type": "iteration", "real_time": 2.0, "label": "1x1x4 -> 1x1x4, a_plain_f32",
           "GB/s": 5.0, "ofRoofline": 0.5, "perFrame": 3.0, "rmsError": 1e-7, "maxError": 1e-6}
    return row | more


OPERATORS = {
    "context": {"device": "a <device>", "peakFlops": "100000000000", "peakBytesPerSecond": "10000000000"},
    "benchmarks": [operator("linear/paper/fp32/out", **{"GFLOP/s": 20.0}), operator("box_mean/paper/fp32/box_mean"),
                   {"name": "bicubic/paper/fp32/bicubic/manual_time", "run_type": "iteration", "error_occurred": True,
                    "error_message": "differs from the reference"}],
}


class Texts(html.parser.HTMLParser):
    """What the page shows, and the links that it follows."""

    def __init__(self, page):
        super().__init__()
        self.shown, self.links, self.tags = "", [], set()
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.links += [value for key, value in attrs if key in ("src", "href")]

    def handle_data(self, data):
        self.shown += data


def make(networks, operators=None):
    """(exit code, page, messages) of the program."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "n.json").write_text(networks if isinstance(networks, str) else json.dumps(networks))
        command = [sys.executable, HERE / "report.py", folder / "n.json", "-o", folder / "r.html"]
        if operators:
            (folder / "o.json").write_text(json.dumps(operators))
            command += ["--operators", folder / "o.json"]
        ended = subprocess.run(command, capture_output=True, text=True)
        made = folder / "r.html"
        return ended.returncode, made.read_text(encoding="utf-8") if made.exists() else "", ended.stderr


class ReportTest(unittest.TestCase):
    def test_one_page_shows_everything(self):
        code, page, messages = make(NETWORKS, OPERATORS)
        self.assertEqual(code, 0, messages)
        texts = Texts(page)
        for words in ("a <device>", "fast", "slow", "Run time against engine error", "Run time against image error", "Scaling",
                      "Memory, 64 × 64", "The frame needs <much> memory", "Operators under the roofline", "no scene",
                      "differs from the reference", "seconds < minutes", "100 GFLOP/s", "10 GB/s"):
            self.assertIn(words, texts.shown)
        self.assertEqual(texts.links, [])
        self.assertNotIn("script", texts.tags)
        self.assertNotRegex(page, r"url\(|@import|https?://")
        self.assertIn("prefers-color-scheme: dark", page)
        self.assertIn('name=viewport', page)

    def test_drawings_stay_inside(self):
        page = make(NETWORKS, OPERATORS)[1]
        drawings = re.findall(r"<svg.*?</svg>", page, re.S)
        self.assertEqual(len(drawings), 4)
        for drawing in drawings:
            root = xml.etree.ElementTree.fromstring(drawing)
            width, height = map(float, root.get("viewBox").split()[2:])
            points = [(float(c.get("cx")), float(c.get("cy"))) for c in root.iter("circle")]
            for line in root.iter("polyline"):
                points += [tuple(map(float, pair.split(","))) for pair in line.get("points").split()]
            self.assertTrue(points)
            for x, y in points:
                self.assertTrue(0 < x < width and 0 < y < height, (x, y))

    def test_front_is_what_nothing_beats(self):
        self.assertEqual(report.pareto_front([(3, 1), (1, 5), (2, 6), (2, 2), (4, 1)]), [(1, 5), (2, 2), (3, 1)])

    def test_numbers_read_well(self):
        self.assertEqual([report.number(x) for x in (1234.5, 0.01234, 3, 99.96)], ["1234", "0.0123", "3", "100"])
        self.assertEqual(report.seconds_text(0.0123), "12.3 ms")
        self.assertEqual(report.power_text(1e-6), "10⁻⁶")

    def test_without_operators_accuracies_or_runs(self):
        self.assertEqual(make(NETWORKS)[0], 0)
        self.assertEqual(make(NETWORKS | {"accuracies": []})[0], 0)
        refused = [row for row in NETWORKS["networks"] if "refused" in row]
        self.assertEqual(make(NETWORKS | {"networks": refused, "accuracies": []})[0], 0)

    def test_other_files_are_refused_in_a_sentence(self):
        for networks, operators, words in (("{", None, "Cannot read"), ("{}", None, "was not written by xrds bench network"),
                                           (NETWORKS, {"context": {}}, "was not written by xrds_bench_operators")):
            code, page, messages = make(networks, operators)
            self.assertEqual((code, page, messages.count("\n")), (1, "", 1))
            self.assertIn(words, messages)


if __name__ == "__main__":
    unittest.main()
