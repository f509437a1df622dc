"""Makes G7Sans-Regular.ttf and ../src/text/widths.rs from IBMPlexSans-Regular.woff.

    npm pack @ibm/plex-sans@1.1.0   # fonts/complete/woff/IBMPlexSans-Regular.woff
    pip install fonttools==4.68.0
    python subset.py IBMPlexSans-Regular.woff
"""

import sys
from fontTools import subset
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont

KEPT = [
    (0x20, 0x7E), (0xA0, 0x17F), (0x18F, 0x18F), (0x192, 0x192), (0x1CD, 0x1D4), (0x218, 0x21B),
    (0x2C6, 0x2DD), (0x386, 0x3CE), (0x400, 0x45F), (0x490, 0x491), (0x4D8, 0x4E9), (0x1E80, 0x1E85),
    (0x1E9E, 0x1E9E), (0x2010, 0x2026), (0x2030, 0x2030), (0x2032, 0x2033), (0x2039, 0x203A),
    (0x2044, 0x2044), (0x2070, 0x208E), (0x20AC, 0x20AC), (0x2116, 0x2116), (0x2122, 0x2122),
    (0x2126, 0x2126), (0x2190, 0x2199), (0x21BA, 0x21BB), (0x2202, 0x2265), (0x25A0, 0x25FF), (0x2713, 0x2717),
]

font = TTFont(sys.argv[1])
font.flavor = None
options = subset.Options()
# No kerning and no ligatures: a line is as wide as the sum of its advances, on
# every machine and in every renderer.
options.layout_features = []
options.hinting = False
options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14]
options.glyph_names = False
options.notdef_outline = True
s = subset.Subsetter(options)
s.populate(unicodes=[c for a, b in KEPT for c in range(a, b + 1)])
s.subset(font)
# The licence reserves the name "Plex" for the original.
for record in list(font["name"].names):
    text = {1: "G7 Sans", 3: "G7 Sans Regular 1", 4: "G7 Sans", 6: "G7Sans-Regular"}.get(record.nameID)
    if text:
        font["name"].setName(text, record.nameID, record.platformID, record.platEncID, record.langID)

def ring(pen, x, y, r, outward):
    """A circle of four arcs, each two quadratic curves."""
    k, d = 0.41421356, 0.70710678
    points = [(1, 0), (1, k), (d, d), (k, 1), (0, 1), (-k, 1), (-d, d), (-1, k)]
    points += [(-a, -b) for a, b in points]
    if outward:
        points = [points[0]] + points[:0:-1]
    at = [(round(x + r * a), round(y + r * b)) for a, b in points]
    pen.moveTo(at[0])
    for i in range(1, 16, 2):
        pen.qCurveTo(at[i], at[(i + 1) % 16])
    pen.closePath()


# The sign of the exclusive or, which the original lacks.
pen = TTGlyphPen(None)
ring(pen, 300, 320, 260, True)
ring(pen, 300, 320, 205, False)
for box in [(272, 110, 328, 530), (90, 292, 510, 348)]:
    x0, y0, x1, y1 = box
    pen.moveTo((x0, y0)); pen.lineTo((x0, y1)); pen.lineTo((x1, y1)); pen.lineTo((x1, y0)); pen.closePath()
font.setGlyphOrder(font.getGlyphOrder() + ["oplus"])
font["glyf"]["oplus"] = pen.glyph()
font["hmtx"]["oplus"] = (600, 40)
for table in font["cmap"].tables:
    if table.isUnicode():
        table.cmap[0x2295] = "oplus"
font["head"].created = font["head"].modified = 0
font.recalcTimestamp = False
font.save("G7Sans-Regular.ttf")

# Runs of characters with their advances, in thousandths of the size.
assert font["head"].unitsPerEm == 1000
cmap, advance = font.getBestCmap(), font["hmtx"]
runs = []
for code in sorted(cmap):
    if not runs or code != runs[-1][0] + len(runs[-1][1]):
        runs.append((code, []))
    runs[-1][1].append(advance[cmap[code]][0])
with open("../src/text/widths.rs", "w", encoding="utf-8") as out:
    print("//! How far each character of the font reaches: made by `font/subset.py`, never by hand.", file=out)
    print(file=out)
    print("/// Runs of characters: the first one, and the advances in thousandths of the size.", file=out)
    print("#[rustfmt::skip]", file=out)
    print("pub(super) const RUNS: &[(u32, &[u16])] = &[", file=out)
    for first, widths in runs:
        print(f"    (0x{first:04X}, &[", file=out)
        for i in range(0, len(widths), 16):
            print("        " + ", ".join(map(str, widths[i : i + 16])) + ",", file=out)
        print("    ]),", file=out)
    print("];", file=out)
