"""Charts of report.py: SVG that scales with its column, bars and tables, coloured by the page's style."""
import html
import math

SERIES = 8  # colours

STYLE = """
:root { color-scheme: light dark; --paper: #fcfcfb; --ink: #1d1d1b; --soft: #62615d; --line: #dddcd7; --bad: #b3261e;
  --c0: #2f6fd0; --c1: #d2641f; --c2: #148a70; --c3: #a8439b; --c4: #8a7000; --c5: #6a58cf; --c6: #bd3a4b; --c7: #6d7680; }
@media (prefers-color-scheme: dark) { :root { --paper: #181817; --ink: #ecebe6; --soft: #a5a49e; --line: #3a3a37; --bad: #ff8a80;
  --c0: #6ea6f5; --c1: #f0915a; --c2: #43c3a4; --c3: #dd86d2; --c4: #cdb145; --c5: #a295f5; --c6: #f0808e; --c7: #9aa4ae; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 76rem; background: var(--paper); color: var(--ink);
  font: 15px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 1.35rem; margin: 0 0 1rem; } h2 { font-size: 1.1rem; margin: 1.6rem 0 .3rem; } h3 { font-size: .95rem; margin: 0 0 .4rem; }
.note, figcaption, .legend { color: var(--soft); font-size: .8rem; } .note { margin: 0 0 .6rem; } .bad { color: var(--bad); }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 24rem), 1fr)); gap: 1.6rem; margin: .6rem 0 1.2rem; }
figure { margin: 0; min-width: 0; } figcaption { margin-top: .4rem; }
svg { display: block; width: 100%; height: auto; max-width: 34rem; } svg text { fill: var(--soft); font-size: 11px; }
svg .name { fill: var(--c); paint-order: stroke; stroke: var(--paper); stroke-width: 3px; stroke-linejoin: round; }
.grid { stroke: var(--line); } .front { fill: none; stroke: var(--soft); stroke-dasharray: 2 3; } .roof { fill: none; stroke: var(--ink); stroke-width: 1.5; }
""" + "".join(f".s{i} {{ --c: var(--c{i}); }} " for i in range(SERIES)) + """
.filled { fill: var(--c); stroke: var(--paper); } .hollow { fill: var(--paper); stroke: var(--c); stroke-width: 1.8; }
.curve { fill: none; stroke: var(--c); stroke-width: 1.6; } .dashed { stroke-dasharray: 5 3; } .cross { stroke: var(--c); stroke-width: 2; }
.legend { display: flex; flex-wrap: wrap; gap: .2rem .9rem; margin-top: .3rem; } .legend span { white-space: nowrap; }
.legend i { display: inline-block; width: .7em; height: .7em; margin-right: .35em; border-radius: 50%; background: var(--c, var(--soft)); border: 2px solid var(--c, var(--soft)); }
.legend i.hollow { background: none; }
.bars { display: grid; grid-template-columns: minmax(0, auto) minmax(4rem, 1fr) auto; gap: .3rem .6rem; align-items: center; font-size: .8rem; }
.bars b { font-weight: normal; overflow-wrap: anywhere; } .bars output { text-align: right; white-space: nowrap; color: var(--soft); }
.track { position: relative; } .bar { height: .75rem; background: var(--c); border-radius: 2px; } .bar.thin { height: .3rem; margin-top: 2px; opacity: .6; }
.tick { position: absolute; top: -2px; height: 1.05rem; width: 2px; background: var(--ink); } .stack { display: flex; height: .9rem; border-radius: 2px; overflow: hidden; }
.stack div { background: var(--c); border-right: 1px solid var(--paper); }
.scroll { overflow-x: auto; margin: .6rem 0 1.2rem; } table { border-collapse: collapse; font-size: .8rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; } th { color: var(--soft); font-weight: 600; }
.text { text-align: left; } td.message { white-space: normal; text-align: left; color: var(--bad); }
dl { font-size: .8rem; } dt { font-weight: 600; } dd { margin: 0 0 .4rem; color: var(--soft); overflow-wrap: anywhere; } summary { cursor: pointer; }
"""


def number(value):
    """Three significant digits, no exponent."""
    if value == 0 or not math.isfinite(value):
        return str(value)
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    text = f"{value:.{min(digits, 9)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


class LogAxis:
    """A logarithmic axis around some positive values, with its title and the text of a tick."""

    def __init__(self, values, title, text, ticks=None):
        low, high = min(values), max(values)
        room = max((high / low) ** 0.08, 1.25, math.sqrt(4 * low / high))  # at least from 1 to 4
        self.low, self.high, self.title, self.text = low / room, high * room, title, text
        self.ticks = ticks or self.round_ticks()

    def round_ticks(self):
        first, last = math.floor(math.log10(self.low)), math.ceil(math.log10(self.high))
        decades = math.log10(self.high / self.low)
        steps = (1, 1.5, 2, 3, 5, 7) if decades < 0.9 else (1, 2, 5) if decades < 2.2 else (1,)
        every = max(1, math.ceil(decades / 7))
        ticks = [step * 10.0 ** exponent for exponent in range(first, last + 1) if exponent % every == 0 for step in steps]
        return [tick for tick in ticks if self.low <= tick <= self.high] or [self.low, self.high]

    def at(self, value):
        """0 at the low end, 1 at the high one."""
        return math.log(value / self.low) / math.log(self.high / self.low)


class Plot:
    """Points and lines over two logarithmic axes, 360 units wide: about as many pixels on a phone."""
    WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 360, 270, 52, 12, 24, 38

    def __init__(self, x_axis, y_axis):
        self.x_axis, self.y_axis, self.parts, self.labels, self.occupied = x_axis, y_axis, [], [], []

    def x(self, value):
        return self.LEFT + self.x_axis.at(value) * (self.WIDTH - self.LEFT - self.RIGHT)

    def y(self, value):
        return self.HEIGHT - self.BOTTOM - self.y_axis.at(value) * (self.HEIGHT - self.TOP - self.BOTTOM)

    def path(self, points, kind):
        if len(points) > 1:
            text = " ".join(f"{self.x(x):.1f},{self.y(y):.1f}" for x, y in points)
            self.parts.append(f'<polyline class="{kind}" points="{text}"/>')

    def line(self, points, series, dashed):
        self.path(points, f"curve s{series}" + (" dashed" if dashed else ""))

    def steps(self, points):
        corners = points[:1]
        for x, y in points[1:]:
            corners += [(x, corners[-1][1]), (x, y)]
        self.path(corners, "front")

    def roof(self, points):
        self.path(points, "roof")

    def marker(self, x, y, series, hollow, title, radius=4.5):
        cx, cy = self.x(x), self.y(y)
        self.occupied.append((cx - radius, cy - radius, cx + radius, cy + radius))
        self.parts.append(f'<circle class="s{series} {"hollow" if hollow else "filled"}" cx="{cx:.1f}" cy="{cy:.1f}" '
                          f'r="{radius}"><title>{html.escape(title)}</title></circle>')

    def refusal(self, x, series, title):
        """A cross at the top edge; several of one place stand below each other."""
        cx, cy = self.x(x), self.TOP + 5
        while any(abs(cx - (a + c) / 2) < 8 and abs(cy - (b + d) / 2) < 8 for a, b, c, d in self.occupied):
            cy += 10
        self.occupied.append((cx - 4, cy - 4, cx + 4, cy + 4))
        self.parts.append(f'<g class="s{series}"><path class="cross" d="M{cx - 3.5:.1f},{cy - 3.5:.1f}l7,7m0,-7l-7,7"/>'
                          f'<title>{html.escape(title)}</title></g>')

    def label(self, x, y, text, series):
        """Beside the point where there is room, else nowhere: the legend and the table have it too."""
        width, cx, cy = 6.1 * len(text), self.x(x), self.y(y)
        for left, base in ((cx + 8, cy + 4), (cx - 8 - width, cy + 4), (cx - width / 2, cy - 9), (cx - width / 2, cy + 18),
                           (cx + 5, cy - 9), (cx - 5 - width, cy - 9), (cx + 5, cy + 16), (cx - 5 - width, cy + 16)):
            box = (left - 1, base - 9, left + width + 1, base + 3)
            inside = box[0] > self.LEFT and box[2] < self.WIDTH - 2 and box[1] > self.TOP - 8 and box[3] < self.HEIGHT - self.BOTTOM - 1
            if inside and not any(box[0] < c and a < box[2] and box[1] < d and b < box[3] for a, b, c, d in self.occupied):
                self.occupied.append(box)
                self.labels.append(f'<text class="name s{series}" x="{left:.1f}" y="{base:.1f}">{html.escape(text)}</text>')
                return

    def svg(self):
        bottom, right = self.HEIGHT - self.BOTTOM, self.WIDTH - self.RIGHT
        grid, last = [], -math.inf
        for tick in self.x_axis.ticks:
            x, text = self.x(tick), self.x_axis.text(tick)
            grid.append(f'<line class="grid" x1="{x:.1f}" y1="{self.TOP}" x2="{x:.1f}" y2="{bottom}"/>')
            half = 3.4 * len(text)
            if x - half > last:
                grid.append(f'<text x="{min(x, self.WIDTH - half):.1f}" y="{bottom + 15}" text-anchor="middle">{html.escape(text)}</text>')
                last = x + half + 6
        for tick in self.y_axis.ticks:
            y = self.y(tick)
            grid.append(f'<line class="grid" x1="{self.LEFT}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
                        f'<text x="{self.LEFT - 5}" y="{y + 4:.1f}" text-anchor="end">{html.escape(self.y_axis.text(tick))}</text>')
        titles = (f'<text x="{right}" y="{self.HEIGHT - 6}" text-anchor="end">{html.escape(self.x_axis.title)} →</text>'
                  f'<text x="2" y="12">↑ {html.escape(self.y_axis.title)}</text>')
        return (f'<svg viewBox="0 0 {self.WIDTH} {self.HEIGHT}" role="img">'
                f'{"".join(grid)}{titles}{"".join(self.parts)}{"".join(self.labels)}</svg>')


def legend(series, shapes):
    """series: (colour, name); shapes: ("filled" or "hollow", name)."""
    items = [f'<span><i class="s{colour}"></i>{html.escape(name)}</span>' for colour, name in series]
    items += [f'<span><i class="{shape}"></i>{html.escape(name)}</span>' for shape, name in shapes]
    return f'<div class="legend">{"".join(items)}</div>'


def bars(entries, text):
    """entries: (name, colour, [(what, value, tick or None)]): the first value a thick bar, later ones thin."""
    if not entries:
        return ""
    largest = max(max(value, tick or 0) for _, _, held in entries for _, value, tick in held)
    rows = []
    for name, colour, held in entries:
        drawn = []
        for i, (what, value, tick) in enumerate(held):
            title = html.escape(f"{what} {text(value)}".strip())
            drawn.append(f'<div class="bar{" thin" if i else ""}" style="width:{100 * value / largest:.2f}%" title="{title}"></div>')
            if tick is not None:
                drawn.append(f'<div class="tick" style="left:calc({100 * tick / largest:.2f}% - 1px)"></div>')
        values = " / ".join(text(value) for _, value, _ in held)
        rows.append(f'<b>{html.escape(name)}</b><div class="track s{colour}">{"".join(drawn)}</div><output>{values}</output>')
    return f'<div class="bars">{"".join(rows)}</div>'


def stacked(entries, text):
    """entries: (name, values): shares of each row's sum, coloured by their place."""
    rows = []
    for name, values in entries:
        whole = sum(values)
        parts = "".join(f'<div class="s{i}" style="width:{100 * value / whole:.2f}%" title="{html.escape(text(value))}"></div>'
                        for i, value in enumerate(values) if value > 0)
        rows.append(f'<b>{html.escape(name)}</b><div class="stack">{parts}</div><output>{html.escape(text(whole))}</output>')
    return f'<div class="bars">{"".join(rows)}</div>'


def table(head, rows, text_columns):
    """The first columns are text; a cell that is (message, columns) spans these."""
    def cell(tag, index, value):
        if isinstance(value, tuple):
            return f'<{tag} class="message" colspan="{value[1]}">{html.escape(value[0])}</{tag}>'
        kind = ' class="text"' if index < text_columns else ""
        return f"<{tag}{kind}>{html.escape(value)}</{tag}>"
    lines = "".join(f"<tr>{''.join(cell('td', i, value) for i, value in enumerate(row))}</tr>" for row in rows)
    return (f'<div class="scroll"><table><thead><tr>{"".join(cell("th", i, value) for i, value in enumerate(head))}</tr></thead>'
            f"<tbody>{lines}</tbody></table></div>")
