"""The fit behind xrds advise, on scenes that follow a straight line."""
import unittest

try:
    import numpy as np

    import advice
except ImportError:
    np = None

SCENES = {f"s{k}": {"noise": -8 + k, "detail": -9 + 0.7 * (k % 4), "guideNoise": -6 + (k % 3)} for k in range(9)}


def rows(offset, model, slope=-2.0):
    """Rows of a map of one way whose PSNR is a line in noise and detail, with two settings."""
    made = []
    for colour, aux in ((64, 16), (16, 4)):
        way = {"way": "merged", "model": model, "scale": 4, "colour": colour, "aux": aux, "data": "val", "average": colour / 16 + aux}
        psnrs = {name: offset + slope * (scene["noise"] - np.log2(colour + 16 * aux)) - 1.5 * scene["detail"] for name, scene in SCENES.items()}
        made.append({**way, "psnrs": psnrs})
    return made


@unittest.skipUnless(np, "needs numpy")
class Advice(unittest.TestCase):
    def test_scenes_on_a_line_are_predicted_without_having_been_seen(self):
        whole = advice.Map(rows(10, "xrds-x4-full") + rows(9, "xrds-x4-compact"), SCENES)
        whole.predict_left_out()
        self.assertLess(np.median([abs(point["predicted"] - point["psnr"]) for point in whole.points]), 0.5)
        for case in whole.regrets():
            self.assertEqual((case["regret"], case["advised"]), (0, "x4-full, merged"))

    def test_ways_say_what_the_rows_were(self):
        whole = advice.Map(rows(10, "xrds-x4-full"), SCENES)
        whole.predict_left_out()
        way, = advice.ways_json(whole)
        self.assertEqual([way[key] for key in ("model", "scale", "merges", "denoisesFirst", "takesFullColour", "guides", "ratios")],
                         ["xrds-x4-full", 4, True, False, True, "rendered", [4.0]])
        self.assertAlmostEqual(way["noise"][0], -8 - np.log2(320), 3)
        self.assertAlmostEqual(way["noise"][1], -np.log2(80), 3)
        scene = SCENES["s4"]
        noise, detail = scene["noise"] - np.log2(320), scene["detail"]
        values = 1, noise, detail, scene["guideNoise"] - 4     # as advice/ways.cpp has them
        self.assertAlmostEqual(np.dot(list(way["coefficients"].values()), values), 10 - 2 * noise - 1.5 * detail, delta=0.3)

    def test_a_regret_is_what_the_best_plan_of_the_budget_has_more(self):
        whole = advice.Map(rows(10, "xrds-x4-full") + rows(9, "xrds-x4-compact"), SCENES)
        for point in whole.points:
            point["predicted"] = -point["psnr"]     # always the worst
        regrets = [case["regret"] for case in whole.regrets() if case["budget"] == 5]
        self.assertEqual(len(regrets), len(SCENES))
        for regret in regrets:
            self.assertAlmostEqual(regret, 1)


if __name__ == "__main__":
    unittest.main()
