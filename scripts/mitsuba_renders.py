#!/usr/bin/env python3
"""Makes the two renders that xrds takes of any scene of Mitsuba 3, with the settings of docs/renderers.md.

    pip install mitsuba        # 3.7 or later; llvm variants need LLVM's library, 16 or later, such as Debian's libllvm19
    python3 scripts/mitsuba_renders.py scene.xml out/        # or "cornell", Mitsuba's own box
    xrds upscale out/low.exr out/full.exr -o out/out.exr --preview out/out.png

Writes low.exr, of a quarter of the resolution, full.exr, and, with --reference, reference.exr, with a box as pixel filter. Each has
colour, albedo, normal and the number of its samples. Albedo and normal are those that mirrors and glass show, as Cycles has them; the albedo
of the sky is its radiance. --guides aov, and variants named scalar, take those of Mitsuba's own integrator: black for mirrors, glass and sky.
"""

import argparse
import pathlib
import time

import drjit
import mitsuba
MOST_BOUNCES = 8
GUIDES = [f"albedo.{c}" for c in "RGB"] + [f"nn.{c}" for c in "XYZ"]
PASS = 1 << 23  # samples of all pixels that an llvm variant has in memory at once


def guides_class():
    """Made once a variant is set: an integrator with albedo and normal beside the colour of another one."""
    class Guides(mitsuba.SamplingIntegrator):
        def __init__(self, nested):
            super().__init__(mitsuba.Properties())
            self.nested = nested

        def aov_names(self):
            return GUIDES

        def sample(self, scene, sampler, ray, medium=None, active=True):
            colour, valid, _ = self.nested.sample(scene, sampler, ray, medium, active)
            return colour, valid, self.guides(scene, sampler, mitsuba.Ray3f(ray), mitsuba.Bool(active))

        @drjit.syntax
        def guides(self, scene, sampler, ray, active):
            weight, albedo, normal = mitsuba.Spectrum(1), mitsuba.Spectrum(0), mitsuba.Normal3f(0)
            bounces = mitsuba.UInt32(0)
            while active:
                hit = scene.ray_intersect(ray, active)
                albedo[active & ~hit.is_valid()] = weight * hit.emitter(scene).eval(hit)
                active &= hit.is_valid()
                numbers = sampler.next_1d(active), sampler.next_2d(active)
                out, reflected = hit.bsdf(ray).sample(mitsuba.BSDFContext(), hit, *numbers, active)
                weight *= reflected
                is_mirror = mitsuba.has_flag(out.sampled_type, mitsuba.BSDFFlags.Delta | mitsuba.BSDFFlags.Null)
                end = active & (~is_mirror | (bounces >= MOST_BOUNCES))
                albedo[end], normal[end] = weight, hit.sh_frame.n
                ray = hit.spawn_ray(hit.to_world(out.wo))
                active &= ~end
                bounces += 1
            return [*albedo, *normal]

    return Guides


def load(scene: str, size: list[int] | None, scale: int, shrink: int):
    """The scene with a film of the size (else its own), cut to a multiple of scale, over shrink."""
    config = mitsuba.parser.ParserConfig(mitsuba.variant())
    if scene == "cornell":
        state = mitsuba.parser.parse_dict(config, mitsuba.cornell_box())
    else:
        mitsuba.file_resolver().prepend(str(pathlib.Path(scene).parent))
        state = mitsuba.parser.parse_file(config, scene)
    film = next(node.props for node in state.nodes if node.type == mitsuba.ObjectType.Film)
    width, height = size or [film.get("width", 768), film.get("height", 576)]
    for key in [key for key in film.keys() if key.startswith("crop_") or key in ("rfilter", "component_format")]:
        del film[key]
    film["width"], film["height"] = (side // scale * scale // shrink for side in (width, height))
    film["rfilter"] = mitsuba.load_dict({"type": "box"})
    film["component_format"] = "float32"
    mitsuba.parser.transform_all(config, state)
    return mitsuba.parser.instantiate(config, state)


def render(scene, guides: str, samples: int, seed: int, path: pathlib.Path) -> None:
    """Writes colour, albedo and normal, as the mean of passes that fit in memory."""
    if guides == "aov" or mitsuba.variant().startswith("scalar"):
        integrator = mitsuba.load_dict({"type": "aov", "aovs": "albedo:albedo,nn:sh_normal", "img": scene.integrator()})
    else:
        integrator = guides_class()(scene.integrator())
    (width, height), begin, total = scene.sensors()[0].film().size(), time.monotonic(), 0
    most = max(1, PASS // (width * height))
    for first in range(0, samples, most):
        count = min(most, samples - first)
        total += mitsuba.render(scene, integrator=integrator, spp=count, seed=(seed << 16) + first) * (count / samples)
        drjit.eval(total)
    bitmap = mitsuba.Bitmap(total, channel_names=["R", "G", "B", "A"][: total.shape[2] - len(GUIDES)] + GUIDES)
    bitmap.metadata()["samplesPerPixel"] = samples
    bitmap.write(str(path))
    print(f"{path}: {bitmap.width()} x {bitmap.height()}, {samples} samples, {time.monotonic() - begin:.1f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--samples", default="64,16", help="of low.exr and full.exr")
    parser.add_argument("--scale", type=int, default=4)
    parser.add_argument("--size", help="WIDTHxHEIGHT of full.exr, else that of the scene")
    parser.add_argument("--guides", choices=["mirrors", "aov"], default="mirrors")
    parser.add_argument("--reference", type=int, help="samples of reference.exr")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    arguments = parser.parse_args()
    mitsuba.set_variant(arguments.variant)
    size = arguments.size and list(map(int, arguments.size.split("x")))
    pathlib.Path(arguments.out).mkdir(parents=True, exist_ok=True)
    low, full = map(int, arguments.samples.split(","))
    wanted = ("low", low, arguments.scale), ("full", full, 1), ("reference", arguments.reference, 1)
    for seed, (name, samples, shrink) in enumerate(wanted[: 3 if arguments.reference else 2]):
        scene = load(arguments.scene, size, arguments.scale, shrink)
        render(scene, arguments.guides, samples, seed, pathlib.Path(arguments.out, f"{name}.exr"))


if __name__ == "__main__":
    main()
