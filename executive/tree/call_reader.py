"""Reads `call`: a tree, the values that go in, and the keys that take what comes out."""

from collections.abc import Mapping

from executive.errors import did_you_mean
from executive.tree.instances import USE, read_uses
from executive.tree.key_source import Ref, Source
from executive.tree.language import TypeName
from executive.tree.leaf_reader import check_port, read_outputs
from executive.tree.node_kinds import Call, Kind
from executive.tree.problem import Mark
from executive.tree.reading import Reading
from executive.tree.value import Table, Value

Ports = Mapping[str, TypeName]


class CallReader:
    """Reads calls; `headers` are the ports of every tree that can be called, by name."""

    def __init__(self, reading: Reading, headers: Mapping[str, tuple[Ports, Ports]]) -> None:
        self._reading, self._headers = reading, headers

    def call(self, table: Table) -> Kind | None:
        """Read `call`."""
        value = table.entries["call"].value
        tree = self._reading.text(value, "'call'")
        if tree is None:
            return None
        if tree not in self._headers:
            if not self._reading.problems.is_partial:
                self._reading.fail(value, f"no tree '{tree}'{did_you_mean(tree, self._headers)}")
            return None
        ins, outs = self._headers[tree]
        given = read_outputs(self._reading, table.get("out"), tuple(outs), tree)
        outputs = {port: given.get(port, Ref(port, value.mark, is_listed=False)) for port in outs}
        inputs = self._inputs(table.get("in"), ins, tree, value.mark)
        use = table.get(USE)
        uses = {} if use is None else read_uses(self._reading, use, tree, None)
        return Call(tree, inputs, outputs, value.mark, uses)

    def _inputs(
        self, value: Value | None, ports: Ports, tree: str, mark: Mark
    ) -> dict[str, Source]:
        inputs: dict[str, Source] = {port: Ref(port, mark, is_listed=False) for port in ports}
        table = self._reading.table(value, f"'in' of {tree}") if value is not None else None
        for port, entry in table.entries.items() if table else ():
            if check_port(self._reading, "in", port, entry.key_mark, tuple(ports), tree):
                source = self._reading.source(entry.value, f"port '{port}'")
                inputs.update({port: source} if source else {})
        return inputs
