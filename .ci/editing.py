"""Measures the messages of `eng lsp` while typing. Usage: editing.py ENG MODEL [EDITS]

ENG is the command. Its server gets EDITS changes (500 without a number) of MODEL, each after the messages about the one before. A
change puts a letter into or takes one from a name, a number or a comment of a line, so about half of the texts have mistakes. The time
of a change runs from its sending to the messages with its number. A line has the median, the 95th percentile and the largest time,
the computing time of the server per change, which other programs on the machine change less, and the memory of the server after the
first tenth of the changes and after the last one. Computing time and memory are read from /proc, so they are stated on Linux alone.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import time

PAUSED_EVERY = 50
PAUSE = 0.6


class Server:
    """The server, as an editor sees it."""

    def __init__(self, command: str) -> None:
        self.process = subprocess.Popen([command, "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.next = 0

    def send(self, message: dict[str, object]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def tell(self, method: str, **params: object) -> None:
        self.send({"method": method, "params": params})

    def receive(self) -> dict[str, object]:
        assert self.process.stdout is not None
        length = 0
        while line := self.process.stdout.readline().strip():
            name, _, value = line.partition(b":")
            if name.lower() == b"content-length":
                length = int(value)
        if not length:
            sys.exit("the server has ended")
        answer: dict[str, object] = json.loads(self.process.stdout.read(length))
        return answer

    def ask(self, method: str, **params: object) -> object:
        self.next += 1
        self.send({"id": self.next, "method": method, "params": params})
        while (answer := self.receive()).get("id") != self.next:
            pass
        return answer.get("result")

    def messages(self, version: int) -> int:
        """The number of messages about the text with a number, once they come."""
        while True:
            message = self.receive()
            params = message.get("params")
            if message.get("method") == "textDocument/publishDiagnostics" and isinstance(params, dict):
                if params.get("version") == version:
                    return len(params["diagnostics"])

    def memory(self) -> float | None:
        """Resident memory (MB)."""
        try:
            status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        except OSError:
            return None
        found = re.search(r"VmRSS:\s+(\d+) kB", status)
        return int(found.group(1)) / 1024 if found else None

    def computed(self) -> float | None:
        """Computing time so far (s)."""
        try:
            fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            return None
        # user and system, fields 14 and 15 of the whole line
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def places(text: str) -> list[tuple[int, int]]:
    """Lines and columns after letters and digits, spread over the text; columns of lines with ASCII alone are UTF-16 units."""
    found = []
    for number, line in enumerate(text.splitlines()):
        if line.isascii():
            found += [(number, match.end()) for match in re.finditer(r"\w+", line)]
    return found


def main() -> None:
    command, model = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 500
    text = model.read_text()
    uri = model.as_uri()
    server = Server(command)
    server.ask("initialize", capabilities={}, processId=None, rootUri=None)
    server.tell("initialized")
    document = {"uri": uri, "languageId": "eng", "version": 0, "text": text}
    begin = time.perf_counter()
    server.tell("textDocument/didOpen", textDocument=document)
    server.messages(0)
    opened = time.perf_counter() - begin
    before = server.computed()
    spread = places(text)
    times, wrong, early = [], 0, None
    for version in range(1, count + 1):
        # each place gets a letter, and loses it with the next change; the step visits all parts of the text
        line, column = spread[(version - 1) // 2 * 37 % len(spread)]
        typed = version % 2 == 1
        end = column if typed else column + 1
        change = {
            "range": {"start": {"line": line, "character": column}, "end": {"line": line, "character": end}},
            "text": "q" if typed else "",
        }
        begin = time.perf_counter()
        server.tell("textDocument/didChange", textDocument={"uri": uri, "version": version}, contentChanges=[change])
        wrong += server.messages(version) > 0
        times.append(time.perf_counter() - begin)
        if version % PAUSED_EVERY == 0:
            # now and then the models are checked, too
            time.sleep(PAUSE)
        if version == max(count // 10, 1):
            early = server.memory()
    late, after = server.memory(), server.computed()
    server.ask("shutdown")
    server.tell("exit")
    server.process.wait(timeout=20)
    times.sort()
    median, most = times[len(times) // 2], times[min(len(times) * 95 // 100, len(times) - 1)]
    computed = f"; computing time {(after - before) / count * 1e3:.1f} ms a change" if before is not None and after is not None else ""
    memory = f"; memory {early:.1f} MB, then {late:.1f} MB" if early is not None and late is not None else ""
    print(
        f"{model.name}: {count} changes, {wrong} texts with messages; opened {opened * 1e3:.0f} ms; "
        f"median {median * 1e3:.1f} ms, 95 % {most * 1e3:.1f} ms, largest {times[-1] * 1e3:.1f} ms{computed}{memory}"
    )


if __name__ == "__main__":
    main()
