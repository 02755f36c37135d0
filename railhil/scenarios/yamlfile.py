"""YAML text as data, without a text that stands for more data than it has, or hides a value."""

from __future__ import annotations

from typing import Any


def parse_yaml(text: str) -> Any:
    """The data of a YAML text of one document.

    Aliases are refused: a few lines of them stand for any amount of data.

    :raises ImportError: PyYAML is not installed.
    :raises ValueError: it is not YAML, has an alias, or the same key twice in a mapping.
    """
    # Imported here, because few scenarios have such a file and every process would load it.
    import yaml

    try:
        loader = yaml.SafeLoader(text)
        top = loader.get_single_node()
        if top is None:
            return None
        seen: set[int] = set()
        rest = [top]
        while rest:
            node = rest.pop()
            if id(node) in seen:
                raise ValueError(f"aliases are not read, and the value in line {node.start_mark.line + 1} has one")
            seen.add(id(node))
            if isinstance(node, yaml.SequenceNode):
                rest += node.value
            elif isinstance(node, yaml.MappingNode):
                keys: set[tuple[str, str]] = set()
                for key, value in node.value:
                    rest += [key, value]
                    if isinstance(key, yaml.ScalarNode):
                        if (key.tag, key.value) in keys:
                            words = f"{key.value[:80]} stands there twice, again in line {key.start_mark.line + 1}"
                            raise ValueError(f"the key {words}")
                        keys.add((key.tag, key.value))
        return loader.construct_document(top)
    except yaml.YAMLError as error:
        raise ValueError(str(error)) from None
