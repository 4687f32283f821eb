"""The tables of the map: the best of each way in its column, the best of all in bold; lines that only rise."""
import unittest

import budget_tables


def row(model, way, average, psnr, colour=16, aux=1):
    return {"data": "val", "way": way, "model": model, "scale": 1 if model == "OIDN" or "-x1-" in model else 4, "colour": colour, "aux": aux, "average": average, "psnr": psnr}


ROWS = [row("OIDN", "Open Image Denoise", 2, 29.8), row("xrds-x4-compact", "network", 2, 27.2), row("xrds-x4-compact", "network", 2, 26.0, 4, 2),
        row("xrds-x4-full", "merged", 2, 29.9), row("OIDN", "Open Image Denoise", 8, 33.1), row("xrds-x4-full", "merged", 8, 32.0, 64, "converged"),
        row("xrds-x1-compact", "denoised first", 8, 32.5, 8, 8)]


class Budgets(unittest.TestCase):
    def test_names(self):
        self.assertEqual([budget_tables.name_of(ROWS[k]) for k in (0, 1, 3)], ["OIDN, full resolution", "x4-compact", "x4-full, merged"])

    def test_table(self):
        self.assertEqual(budget_tables.table(ROWS).splitlines(), [
            "| average | OIDN, full resolution | x1-compact, denoised first | x4-compact | x4-full, merged |", "|---|---|---|---|---|",
            "| 2 | 29.80 |  | 27.20 (16-1) | **29.90 (16-1)** |", "| 8 | **33.10** | 32.50 |  | 32.00 (64) |"])

    def test_front_page(self):
        live = [{**row("xrds-x2-live", "denoised first", 1 / 4, 26.5, 1, "converged"), "data": "live"}, {**row("OIDN", "Open Image Denoise", 1, 29, 1, "converged"), "data": "live"}]
        found = budget_tables.front_page({"rows": ROWS + live}).splitlines()
        self.assertIn("| 1/4 |  | **26.50** x2-live + OIDN |  |  |", found)
        self.assertIn("| 1 | **29.00** |  |  |  |", found)
        self.assertIn("| 2 |  |  | 29.80 | **29.90** x4-full |", found)

    def test_front_rises(self):
        worse = [row("xrds-x4-compact", "network", average, psnr) for average, psnr in ((1, 25), (2, 24), (4, 26), (4, 25.5))]
        self.assertEqual([(found["average"], found["psnr"]) for found in budget_tables.front(worse)], [(1, 25), (4, 26)])


if __name__ == "__main__":
    unittest.main()
