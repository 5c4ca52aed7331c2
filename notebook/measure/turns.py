"""What the programs share that measure ways to render in turns."""
import subprocess

from project import Parser, number, program_file, read_json


def options_of(question, doc, runs, samples, output):
    """The options of a command that measures a device, and under `seconds` the key of a report's row that tells its time."""
    parser = Parser(f"./lab notebook {question}", doc)
    parser.add_argument("--runs", type=number(int, 2), default=runs, help=f"default: {runs}")
    parser.add_argument("--backend", default="native", help="default: native")
    parser.add_argument("--samples", type=number(int, 2), default=samples, help=f"per pixel; default: {samples}")
    parser.add_argument("--output", type=type(output), default=output, metavar="FILE.json")
    options = parser.parse_args()
    options.seconds = "cpu_seconds" if options.backend == "native" else "device_seconds"
    return options


def rendered(chapter, scene, folder, *options):
    """Renders a scene into picture.exr of a folder. Returns the report."""
    report = folder / "report.json"
    outputs = [f"--output={folder / 'picture.exr'}", f"--report={report}"]
    subprocess.run([program_file(chapter), scene, "--headless", "--quiet", *options, *outputs], check=True)
    return read_json(report)
