"""For gdb: shows vectors and arrays of shaders in GLSL's notation."""
import gdb
import gdb.printing


class Vector:
    def __init__(self, value):
        self.value = value

    def to_string(self):
        size = int(self.value.type.strip_typedefs().template_argument(0))
        return "(" + ", ".join(str(self.value[letter]) for letter in "xyzw"[:size]) + ")"


class Matrix:
    def __init__(self, value):
        self.columns = value["value"]

    def to_string(self):
        low, high = self.columns.type.range()
        return "(" + ", ".join(Vector(self.columns[i]).to_string() for i in range(low, high + 1)) + ")"


class Buffer:
    """The array at the end of a buffer: its number of elements, and the first ones."""

    def __init__(self, value):
        self.value = value

    def to_string(self):
        return f"{int(self.value['size'])} elements"

    def children(self):
        shown = min(int(self.value["size"]), 3)
        return ((f"[{i}]", self.value["elements"][i]) for i in range(shown))


printers = gdb.printing.RegexpCollectionPrettyPrinter("path tracing lab")
printers.add_printer("vector", r"^glm::vec<", Vector)
printers.add_printer("matrix", r"^glm::mat<", Matrix)
printers.add_printer("buffer", r"^lab::native::Span<", Buffer)
gdb.printing.register_pretty_printer(None, printers, replace=True)
