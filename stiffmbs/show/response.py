"""Frequency responses as text, as JSON and as CSV."""

from __future__ import annotations

import json

import numpy as np

from ..linear_analysis.transfer import Transfer


def response_text(scene: str, found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return the gain and phase of each input and output at both ends, and at the peaks, as text.

    `frequencies` of shape (n,): frequencies, Hz. `values` of shape (n, outputs, inputs).
    """
    lines = [f"{scene}: gain and phase from {frequencies[0]:g} Hz to {frequencies[-1]:g} Hz"]
    for i, name in enumerate(found.inputs):
        for o, output in enumerate(found.outputs):
            lines.append(f"{name} -> {output}")
            gain, phase = np.abs(values[:, o, i]), np.degrees(np.angle(values[:, o, i]))
            inner = np.flatnonzero((gain[1:-1] > gain[:-2]) & (gain[1:-1] > gain[2:])) + 1
            for k in (0, *inner.tolist(), len(gain) - 1):
                mark = "peak" if k in inner else ""
                lines.append(f"  {frequencies[k]:>10.5g} Hz  {gain[k]:>12.5g}  {phase[k]:>8.2f} deg  {mark}".rstrip())
    return "\n".join(lines)


def response_as_json(scene: str, found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return frequencies, and real and imaginary part by input and output, as JSON; arguments as of `response_text`."""
    parts = {
        name: {
            output: [[value.real, value.imag] for value in values[:, o, i].tolist()]
            for o, output in enumerate(found.outputs)
        }
        for i, name in enumerate(found.inputs)
    }
    return json.dumps({"scene": scene, "frequencies": frequencies.tolist(), "response": parts})


def response_csv(found: Transfer, frequencies: np.ndarray, values: np.ndarray) -> str:
    """Return columns of gain and phase as CSV; arguments as of `response_text`."""
    pairs = [(i, o) for i in range(len(found.inputs)) for o in range(len(found.outputs))]
    names = [f"{found.inputs[i]} -> {found.outputs[o]} {part}" for i, o in pairs for part in ("gain", "phase [deg]")]
    columns = [
        part for i, o in pairs for part in (np.abs(values[:, o, i]), np.degrees(np.unwrap(np.angle(values[:, o, i]))))
    ]
    rows = [",".join(["frequency [Hz]", *names])]
    rows += [",".join(f"{number:.15g}" for number in row) for row in np.column_stack([frequencies, *columns])]
    return "\n".join(rows) + "\n"
