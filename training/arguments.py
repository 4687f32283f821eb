"""Types of command-line options (argparse's `type`), which refuse in a sentence what a program cannot use."""
import argparse
import math
import pathlib

import torch


class Parser(argparse.ArgumentParser):
    """Says what is wrong with the command line in a sentence, without the list of options."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {message}\n")


def number(kind, least, most=math.inf, above=False):
    """A type: int or float from `least` (`above`: more than it) to `most`."""
    limit = f"more than {least}" if above else f"at least {least}" if most == math.inf else f"from {least} to {most}"

    def read(text):
        try:
            value = kind(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is no {'whole ' if kind is int else ''}number") from None
        if not least <= value <= most or above and value == least:      # NaN is in no range
            raise argparse.ArgumentTypeError(f"must be {limit}, found {text}")
        return value
    return read


def shares_of(text):
    """{sample count: share} of "1:0.3,4:0.7" or "16"; None of None. Raises ValueError on others."""
    found = {}
    for part in text.split(",") if text else ():
        spp, _, share = part.partition(":")
        found[int(spp)] = float(share or 1)
    if not all(spp >= 0 and 0 <= share < math.inf for spp, share in found.items()) or found and not any(found.values()):
        raise ValueError
    return found or None


def pairs_of(text):
    """[(samples of the colour, of the auxiliary images)] of "64-16,16-1". Raises ValueError on others."""
    pairs = [tuple(int(spp) for spp in pair.split("-")) for pair in text.split(",")]
    if any(len(pair) != 2 or pair[0] < 1 for pair in pairs):
        raise ValueError
    return pairs


def read_by(read, example):
    """A type: a text that read() takes, as the example. The text itself is kept: cards and logs show it."""
    def checked(text):
        try:
            read(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text!r} is not of the form {example}") from None
        return text
    return checked


shares = read_by(shares_of, "1:0.3,4:0.7, sample counts and shares of at least 0, or one count")
pairs = read_by(pairs_of, "64-16,16-1, samples of the colour and of the auxiliary images")


def device(text):
    """A type: a device that PyTorch can use here."""
    try:
        torch.empty(1, device=text)
    except (RuntimeError, AssertionError) as error:
        reason = str(error).strip().partition("\n")[0]
        raise argparse.ArgumentTypeError(f"{text!r} cannot be used: {reason}") from None
    return text


def folder(text):
    """A type: a folder that is there."""
    if not pathlib.Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"{text} is no folder")
    return pathlib.Path(text)
