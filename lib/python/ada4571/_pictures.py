# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Small pictures for notebooks."""
import numpy as np

# Points that a picture of this size can show apart.
_POINTS = 2000


def _circle(recording, size=240):
    """The Lissajous figure of the two signals, in the supply's square."""
    step = max(1, len(recording) // _POINTS)
    x = recording.vcos_v[::step] / recording.supply_v * size
    y = size - recording.vsin_v[::step] / recording.supply_v * size
    dots = "".join(f"M{a:.1f} {b:.1f}h0" for a, b in np.column_stack([x, y]))
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" height="{size}" '
            f'viewBox="0 0 {size} {size}"><title>VSIN against VCOS</title>'
            f'<rect width="{size}" height="{size}" fill="none" stroke="#888"/>'
            f'<path d="M0 {size / 2}H{size}M{size / 2} 0V{size}" stroke="#ccc"/>'
            f'<path d="{dots}" stroke="#0060a0" stroke-width="2" stroke-linecap="round"/></svg>')


def recording(capture):
    """The figure, and what is known of the capture beside it."""
    rows = [("samples", len(capture)), ("duration", f"{capture.duration_s:g} s"),
            ("supply", f"{capture.supply_v:g} V"), ("periods a turn", capture.periods_per_turn)]
    table = "".join(f"<tr><th>{name}</th><td>{value}</td></tr>" for name, value in rows)
    return f'<div style="display:flex;gap:1em">{_circle(capture)}<table>{table}</table></div>'
