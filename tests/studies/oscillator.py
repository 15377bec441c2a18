"""A damped oscillator: scene, closed form, and the derivatives of closed forms."""

import numpy as np

SLED = """
parameters: {k: 100 N/m, c: 1 N s/m, x0: 0.1 m, m: 2 kg}
bodies: {sled: {mass: m, inertia: 1, position: [x0, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: force, i: sled, force: ["-k*sled.x - c*sled.vx", 0]}
run: {duration: 2, rtol: 1e-7, points: 41}
"""


def oscillation(t, k=100.0, c=1.0, x0=0.1, m=2.0):
    d, w = c / (2 * m), np.sqrt(k / m - (c / (2 * m)) ** 2)
    return x0 * np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t))


def slope(function, name, value):
    """By central differences of fourth order of a closed form."""
    h = 1e-3 * value
    f = [function(**{name: value + shift * h}) for shift in (-2, -1, 1, 2)]
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)
