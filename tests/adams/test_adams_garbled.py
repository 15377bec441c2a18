"""Datasets whose text is garbled at random: each is read, or refused with a sentence, and `check` can list its statements."""

import re
from random import Random

import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.adams.load import read_adams

from .test_adams_touching_curves import FACE, dataset, ellipse
from .trials.adams_random_statements import random_statements

SIGNS = ',=/&!()*-0 9DE.:\\"'


def originals():
    cam = dataset(ellipse(40, 40), FACE, (15, 0), 40, spin=8.0)
    return [cam, *(random_statements(seed).text() for seed in range(4))]


def garbled(text, random):
    """A dataset with a line gone, doubled or moved, a sign gone or added, other numbers, or other words."""
    lines = text.split("\n")
    k, m = random.randrange(len(lines)), random.randrange(len(lines))
    at = random.randrange(len(lines[k]) + 1)
    words = re.findall("[A-Z_]{3,}", text)
    match random.randrange(8):
        case 0:
            del lines[k]
        case 1:
            lines.insert(k, lines[m])
        case 2:
            lines[k], lines[m] = lines[m], lines[k]
        case 3:
            lines[k] = lines[k][:at] + lines[k][at + 1 :]
        case 4:
            lines[k] = lines[k][:at] + random.choice(SIGNS) + lines[k][at:]
        case 5:
            lines[k] = re.sub(r"-?\d+\.?\d*", lambda found: random.choice(("0", "-1", "1e30", "x", found[0])), lines[k])
        case 6:
            lines[k] = lines[k].lower()
        case 7:
            lines[k] = re.sub(
                "[A-Z_]{3,}", lambda found: random.choice(words) if random.random() < 0.5 else found[0], lines[k]
            )
    return "\n".join(lines)


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 10))])
@pytest.mark.sampled(11)
def test_a_garbled_dataset_is_read_or_refused(tmp_path, seed):
    random, texts = Random(seed), originals()
    read = refused = 0
    for _ in range(10 if seed == 0 else 100):
        text = random.choice(texts)
        for _ in range(random.choice((1, 1, 2, 3))):
            text = garbled(text, random)
        try:
            read_adams(text)
            read += 1
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
        (tmp_path / "model.adm").write_text(text)
        assert stiffmbs.listed_statements(tmp_path / "model.adm")
    assert read and refused


@pytest.mark.parametrize(
    "fields", ["QP=1E160,0,0", "QP=0,1E155,0", "QP=1E154,1E154,0", "QP=0,0,-1E308", "QP=1E200,0,0, REULER=1,1,1"]
)
def test_inertias_beyond_all_numbers_are_refused(fields):
    text = (
        "ADAMS title\nPART/1, GROUND\nMARKER/1, PART=1\nPART/2, MASS=1, CM=4, IM=5, IP=1,1,1\nMARKER/4, PART=2\n"
        f"MARKER/5, PART=2, {fields}\nACCGRAV/JGRAV=-9.8\nEND\n"
    )
    with pytest.raises(InputError, match=r"PART/2: found moments of inertia about CM above 1e308"):
        read_adams(text)
