"""Drives the program `umbravox` on an exported scene."""

import json
import subprocess
import tempfile
from pathlib import Path

from pictures import read_png


class Ours:
    """A session that draws one frame whenever it is asked to."""

    name = "umbravox"

    def __init__(self, program, scene_path, settings):
        self.program = program
        self.input = [str(scene_path)]
        for key, value in settings.items():
            self.input += ["--set", f"{key}={json.dumps(value)}"]
        command = [program, "bench", *self.input, "--paced", "--json", "--orbit", "0", "--warmup", "0"]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def frame(self):
        """Wall and processor time of one frame, ms: recording to completion, without read-back."""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self.program} ended with status {self.process.wait()}")
        time = json.loads(line)
        return time["wall_ms"], time["cpu_ms"]

    def picture(self):
        """Display colours, (height, width, 3), 0 to 255."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "ours.png"
            subprocess.run([self.program, "render", *self.input, "-o", str(path)], check=True)
            return read_png(path)

    def close(self):
        """Ends the session; its report: device and counters."""
        report, _ = self.process.communicate()
        return json.loads(report)["stats"]
