"""The network in ncnn: converted by pnnx from a form that computes the same with tensors of at most four dimensions.

ncnn has no tensor of five dimensions and no roll, both of which training/network.py uses for its windows. Here the
windows are cut by two reshapes and a transposition in four dimensions, the roll is a concatenation of two slices, and
q, k and v are separate linear layers. peers.py compares the output with PyTorch's of training/network.py itself.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import numpy

MASKED = -1e4   # in place of minus infinity, which pnnx does not write
PATIENCE = 300  # seconds, for a conversion; attention of many windows takes longer
SMALL = 32      # pixels of a low-resolution image that pnnx runs networks with where the size does not matter


def windows_of(x, w):
    """[1, h, v, c] -> [h/w * v/w, w*w, c]"""
    _, h, v, c = map(int, x.shape)
    return x.reshape(h // w, w, v // w, w * c).permute(0, 2, 1, 3).reshape(-1, w * w, c)


def image_of(windows, h, v, w):
    """Inverse of windows_of."""
    c = int(windows.shape[-1])
    return windows.reshape(h // w, v // w, w, w * c).permute(0, 2, 1, 3).reshape(1, h, v, c)


def rolled(x, shift):
    """torch.roll of [1, h, v, c] by (shift, shift)."""
    import torch
    x = torch.cat([x[:, -shift:], x[:, :-shift]], 1)
    return torch.cat([x[:, :, -shift:], x[:, :, :-shift]], 2)


def attention(self, x, memory=None, shifted=False):
    """WindowAttention.forward of training/network.py."""
    import network
    import torch
    _, h, v, c = map(int, x.shape)
    w, shift = self.window, self.window // 2
    tokens = w * w

    def heads(windows, layer, part, parts):
        weight, bias = layer.weight.view(parts, c, c)[part], layer.bias.view(parts, c)[part]
        y = torch.nn.functional.linear(windows.reshape(-1, c), weight, bias)
        return y.reshape(-1, tokens, self.heads, c // self.heads).permute(0, 2, 1, 3)

    own = windows_of(rolled(x, -shift) if shifted else x, w)
    other = windows_of(memory, w) if self.cross else own
    q = heads(own, self.q, 0, 1) if self.cross else heads(own, self.qkv, 0, 3)
    k, value = (heads(other, self.kv, i, 2) if self.cross else heads(other, self.qkv, 1 + i, 3) for i in range(2))
    scores = torch.matmul(q * self.scale, k.transpose(-2, -1)) + self.bias().detach()[None]
    if shifted:
        scores = scores + network.shift_mask(h, v, w, x.device)[:, None].clamp(min=MASKED)
    y = torch.matmul(scores.softmax(-1), value).permute(0, 2, 1, 3).reshape(-1, c)
    x = image_of(self.proj(y).reshape(-1, tokens, c), h, v, w)
    return rolled(x, shift) if shifted else x


def sizes_do_not_matter(model):
    """Whether the converted network is the same for frames of every size: attention counts out its windows."""
    import network
    return not any(isinstance(module, network.WindowAttention) for module in model.modules())


def cropped(inputs):
    """The leading part of the images, the first of them of SMALL x SMALL pixels: pnnx runs the network several times, which takes minutes at full size."""
    unit = inputs[0].shape[-1] // SMALL
    return tuple(image[:, :, :image.shape[2] // unit, :image.shape[3] // unit].contiguous() for image in inputs) if unit > 1 else inputs


def first_output(torch, model):
    """Ours has a second one, which may be None; that cannot be traced."""
    class First(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.model = model

        def forward(self, *inputs):
            outputs = self.model(*inputs)
            return outputs[0] if isinstance(outputs, tuple) else outputs
    return First()


def convert(torch, model, inputs, path):
    """Writes path.ncnn.param and path.ncnn.bin for the sizes of the inputs. Throws with what ncnn lacks, if anything."""
    import network
    inputs = cropped(inputs) if sizes_do_not_matter(model) else inputs
    original = network.WindowAttention.forward
    network.WindowAttention.forward = attention
    try:
        with torch.inference_mode():
            torch.jit.trace(first_output(torch, model), inputs, check_trace=False).save(path + ".pt")
    finally:
        network.WindowAttention.forward = original
    pnnx = shutil.which("pnnx", path=str(pathlib.Path(sys.executable).parent) + os.pathsep + os.environ["PATH"])
    shapes = ",".join("[" + ",".join(map(str, x.shape)) + "]" for x in inputs)
    subprocess.run([pnnx or "pnnx", path + ".pt", "inputshape=" + shapes, "fp16=0"], check=True, stdout=subprocess.DEVNULL,
                   timeout=PATIENCE)
    layers = {line.split()[0] for line in pathlib.Path(path + ".ncnn.param").read_text().splitlines()[2:]}
    unknown = sorted(layer for layer in layers if re.search(r"[._]|^aten|^pnnx", layer))
    if unknown:
        raise RuntimeError("pnnx left layers that ncnn lacks: " + ", ".join(unknown))


def widen_lavapipe(folder):
    """The vector width that the engine chooses, and a shader cache for it: Mesa's key leaves the width out."""
    if "avx512vl" in pathlib.Path("/proc/cpuinfo").read_text():
        os.environ["LP_NATIVE_VECTOR_WIDTH"] = "512"
        os.environ["MESA_SHADER_CACHE_DIR"] = folder


def ncnn_frame(torch, model, path, arrays, threads, vulkan):
    """A function that runs one frame in fp32 and returns the raw output as an array."""
    convert(torch, model, tuple(map(torch.from_numpy, arrays)), path)
    widen_lavapipe(str(pathlib.Path(path).parent / "mesa-w512"))
    import ncnn
    net = ncnn.Net()
    net.opt.num_threads = threads
    net.opt.use_vulkan_compute = vulkan
    net.opt.use_fp16_packed = net.opt.use_fp16_storage = net.opt.use_fp16_arithmetic = net.opt.use_bf16_storage = False
    if net.load_param(path + ".ncnn.param") or net.load_model(path + ".ncnn.bin"):
        raise RuntimeError("ncnn cannot load what pnnx wrote")
    inputs = [ncnn.Mat(array[0]).clone() for array in arrays]      # else of memory that is not theirs

    def frame():
        with net.create_extractor() as extractor:
            for i, mat in enumerate(inputs):
                extractor.input(f"in{i}", mat)
            failed, output = extractor.extract("out0")
        if failed:
            raise RuntimeError(f"ncnn failed with {failed}")
        return numpy.asarray(output)[None]
    return frame
