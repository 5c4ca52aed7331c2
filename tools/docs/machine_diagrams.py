"""Diagrams of the machine: tables, structures, the way of a frame, lanes. A function each; what can be computed is not placed by eye."""
from docs.drawing import BLUE, GREEN, GREY, ORANGE, PURPLE, RED, Drawing


def build_alias_table(weights):
    """For each item the part of its column that it keeps, and the item that fills the rest: common/scene/alias_table.cpp without rounding."""
    share = [weight * len(weights) / sum(weights) for weight in weights]
    small = [i for i, part in enumerate(share) if part < 1]
    large = [i for i, part in enumerate(share) if part >= 1]
    table = [(1, i) for i in range(len(weights))]
    while small:
        item, filler = small.pop(), large[-1]
        table[item] = share[item], filler
        share[filler] -= 1 - share[item]
        if share[filler] < 1:
            small.append(large.pop())
    return table


def alias_table():
    weights = [6, 2, 1, 9, 5, 1]
    drawing = Drawing(
        "Alias table", 320,
        "Bars of unequal weights are cut and rearranged into columns of equal height. Each column holds at most two "
        "items: its own one, and another one that is its alias.")
    base, unit, width, distance = 240, 22, 32, 42
    mean = sum(weights) / len(weights)
    for i, weight in enumerate(weights):
        x = 40 + distance * i
        low = min(weight, mean)
        drawing.rectangle((x, base - unit * low), (width, unit * low), BLUE)
        if weight > mean:
            drawing.rectangle((x, base - unit * weight), (width, unit * (weight - mean)), ORANGE)
        drawing.label((x + width / 2, base + 16), str(i), BLUE)
    drawing.line([(30, base - unit * mean), (300, base - unit * mean)], dashed=True)
    drawing.label((348, base - unit * mean), "mean", size=14, anchor="end")
    drawing.arrow([(306, base - unit * mean / 2), (348, base - unit * mean / 2)], width=2.4)
    tall = unit * mean
    for i, (kept, alias) in enumerate(build_alias_table(weights)):
        x, border = 365 + distance * i, base - tall * kept
        drawing.rectangle((x, border), (width, tall * kept), BLUE)
        if alias != i:
            drawing.rectangle((x, base - tall), (width, border - base + tall), ORANGE)
            drawing.label((x + width / 2, (base - tall + border) / 2), str(alias), ORANGE)
        drawing.label((x + width / 2, base + 16), str(i), BLUE)
    drawing.label((165, 290), "weights of the items")
    drawing.lines_of_text((487, 282), ["choose a column uniformly,", "then a height: own item or alias"], size=14, anchor="middle")
    drawing.label((487, 90), "alias", ORANGE)
    drawing.label((487, 115), "number of the item that fills the rest", ORANGE, 13)
    return drawing


def shader_binding_table():
    classes = {"diffuse": GREEN, "dielectric": PURPLE}  # in the order of their hit records
    meshes = {"room": ["diffuse"], "torus": ["dielectric"], "bottle": ["diffuse", "dielectric"]}  # a geometry for each class
    instances = ["room", "torus", "torus", "bottle"]
    drawing = Drawing(
        "From a hit to its shader", 380,
        "The instances of the top level refer to bottom levels, whose geometries have a material class each. Instance "
        "offset and geometry index lead to the record of the hit shader.")
    names, stride, first_hit = list(classes), 1, 3
    offsets = {mesh: names.index(contents[0]) for mesh, contents in meshes.items()}
    records = ["ray generation", "miss", "shadow miss", *(f"hit record {i}: {name}" for i, name in enumerate(names))]
    record_places = [(455, 62 + 40 * i + (14 if i >= first_hit else 0)) for i in range(len(records))]
    for x, title in ((82, "top level (TLAS)"), (292, "bottom levels (BLAS)"), (540, "shader binding table")):
        drawing.label((x, 22), title)
    geometry_places, bottom = {}, 52
    for mesh, contents in meshes.items():
        height = 30 + 34 * len(contents)
        drawing.rectangle((207, bottom), (170, height), BLUE, 0.08)
        drawing.label((217, bottom + 15), mesh, BLUE, 14, "start")
        geometry_places[mesh] = []
        for index, name in enumerate(contents):
            y = bottom + 30 + 34 * index
            drawing.rectangle((217, y - 3), (150, 28), classes[name], 0.15)
            drawing.label((292, y + 11), f"geometry {index}: {name}", classes[name], 12)
            geometry_places[mesh].append((367, y + 11))
        bottom += height + 16
    drawing.rectangle((10, 42), (145, 72 * len(instances) + 6), ORANGE, 0)
    for i, mesh in enumerate(instances):
        y = 52 + 72 * i
        drawing.rectangle((20, y), (125, 56), ORANGE, 0.12)
        drawing.label((82, y + 17), f"instance {i}: {mesh}", ORANGE, 13)
        drawing.label((82, y + 39), f"offset {offsets[mesh]}", ORANGE, 13)
        middle = sum(place[1] for place in geometry_places[mesh]) / len(meshes[mesh])
        drawing.arrow([(145, y + 28), (205, middle - 8)], ORANGE, 1.4)
    for i, (mesh, contents) in enumerate(meshes.items()):
        for index, (start, name) in enumerate(zip(geometry_places[mesh], contents)):
            x, y = record_places[first_hit + offsets[mesh] + index * stride]
            drawing.arrow([start, (x - 2, y + 9 + 6 * i)], classes[name], 1.4)
    for i, (text, (x, y)) in enumerate(zip(records, record_places)):
        colour = classes[names[i - first_hit]] if i >= first_hit else GREY
        drawing.rectangle((x, y), (172, 30), colour, 0.15)
        drawing.label((x + 86, y + 15), text, colour, 12)
    drawing.label((320, 360), "hit record = instance offset + geometry index · stride")
    return drawing


def frame():
    drawing = Drawing(
        "The way of a frame", 290,
        "A scene file becomes a Scene, a GpuScene, an acceleration structure, a tracer, and with the renderer's "
        "dispatches a film and a picture. Each box names the room of common/ that it belongs to.")
    steps = [("scene file", "assets/", GREY), ("Scene", "scene/", GREEN), ("GpuScene", "tracing/", BLUE),
             ("Acceleration Structure", "tracing/", BLUE), ("Tracer", "tracing/", BLUE), ("Renderer", "rendering/", PURPLE),
             ("Film", "rendering/", PURPLE), ("picture", "image/", ORANGE)]
    width, height = 124, 70
    places = [(15 + 162 * i, 40) for i in range(4)] + [(15 + 162 * i, 165) for i in reversed(range(4))]
    for (x, y), (to_x, to_y) in zip(places, places[1:]):
        gap = (width + 3) if to_x > x else -3
        start, end = ((x + gap, y + 35), (to_x + width - gap, y + 35)) if to_x != x else ((x + 62, y + height + 3), (x + 62, to_y - 3))
        drawing.arrow([start, end], width=2.2)
    for (x, y), (name, room, colour) in zip(places, steps):
        drawing.rectangle((x, y), (width, height), colour, 0.12, 1.8)
        words = name.split()
        for i, word in enumerate(words if len(name) > 12 else [name]):
            drawing.label((x + 62, y + (14 if len(name) > 12 else 25) + 18 * i), word, colour)
        drawing.label((x + 62, y + 56), room, colour, 12)
    for at, anchor, text in (
            ((239, 26), "middle", "load_scene()"), ((635, 26), "end", "build_acceleration_structure()"), ((557, 138), "end", "make_tracer()"),
            ((401, 250), "middle", "dispatches"), ((239, 250), "middle", "sums of samples"), ((77, 250), "middle", "write_picture()")):
        drawing.label(at, text, size=12, anchor=anchor)
    drawing.arrow([(563, 268), (563, 238)], RED)
    drawing.label((563, 278), "path_trace.glsl", RED, 14)
    return drawing


def warp_lanes():
    # Rays of each path.
    lanes = [(2, 1, 5, 2), (1, 3, 1, 4), (3, 1, 2, 2), (1, 6, 1, 2), (5, 1, 1, 3), (2, 2, 3, 1), (1, 1, 4, 1), (4, 2, 1, 2)]
    drawing = Drawing(
        "Lanes of a warp", 360,
        "Eight lanes render four samples each. In chapter 9 all wait for the longest path of each sample. In chapter 10 a "
        "lane starts its next path at once, and only the end is idle.")
    left, unit, row, colours = 70, 27, 15, (BLUE, GREEN, PURPLE, RED)
    longest = [max(paths) for paths in zip(*lanes)]
    together = [[sum(longest[:k]) for k in range(len(longest))] for _ in lanes]
    at_once = [[sum(paths[:k]) for k in range(len(paths))] for paths in lanes]
    for top, title, starts, end in ((36, "chapter 9: all wait for the longest path", together, sum(longest)),
                                    (212, "chapter 10: each starts its next path at once", at_once, max(map(sum, lanes)))):
        idle = 1 - sum(map(sum, lanes)) / (end * len(lanes))
        drawing.label((left, top - 16), f"{title}: {100 * idle:.0f} % idle", anchor="start")
        for lane, (paths, begins) in enumerate(zip(lanes, starts)):
            y = top + row * lane
            drawing.label((left - 8, y + row / 2), f"lane {lane}", size=11, anchor="end")
            for rays, begin, next_begin, colour in zip(paths, begins, [*begins[1:], end], colours):
                drawing.line([(left + unit * (begin + rays), y + row / 2), (left + unit * next_begin, y + row / 2)], width=1, dashed=True)
                drawing.rectangle((left + unit * begin + 1, y + 1), (unit * rays - 2, row - 3), colour, 0.6, 1)
        bottom = top + row * len(lanes)
        drawing.line([(left + unit * end, top - 4), (left + unit * end, bottom + 4)], ORANGE, 2)
    drawing.arrow([(left, 348), (left + unit * sum(longest), 348)], width=1.2)
    drawing.label((left + 330, 336), "time", size=14)
    return drawing
