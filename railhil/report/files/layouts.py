"""Layouts of other viewers for the files of a run: a chart for each group of columns, as in panel and report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from railhil.bus.ros2 import SIGNALS_TOPIC, ros_name
from railhil.common.streams import escape_controls
from railhil.report.display_columns import ColumnGroup, grouped
from railhil.report.files.content import Content
from railhil.report.styles import Style

#: Black cannot be seen on the ground of asammdf.
_COLOURS = tuple(colour for colour in (Style(law).colour for law in range(7)) if colour != "#000000")
#: Size of the area for which asammdf's windows are placed, in px.
_WIDTH_PX, _HEIGHT_PX = 1600, 900


def write_lichtblick(content: Content, path: Path) -> None:
    """Write a layout of Lichtblick and Foxglove for ``run.mcap`` and for the bridge of a live run, which have the same
    topic.

    Format: Lichtblick's ``LayoutData`` and ``PlotConfig`` (suite-base, MPL-2.0), read of version 1.29.
    """
    plots = {}
    for number, group in enumerate(_groups(content)):
        unit = content.units[group.columns[0].name]
        paths = [
            {
                "value": f"{SIGNALS_TOPIC}.{ros_name(column.name)}", "label": column.label, "enabled": True,
                "timestampMethod": "receiveTime",
            }
            for column in group.columns
        ]  # fmt: skip
        plots[f"Plot!railhil{number}"] = {
            "paths": paths, "showLegend": True, "legendDisplay": "floating", "showPlotValuesInLegend": True,
            "showXAxisLabels": True, "showYAxisLabels": True, "isSynced": True, "xAxisVal": "timestamp",
            "sidebarDimension": 240, "yAxisLabel": f"{group.title} [{unit}]" if unit else group.title,
            "lichtblickPanelTitle": group.title, "foxglovePanelTitle": group.title,
        }  # fmt: skip
    halves = [_stacked(half) for half in _halves(list(plots)) if half]
    layout = halves[0] if len(halves) == 1 else {"first": halves[0], "second": halves[1], "direction": "row"}
    _write_json(path, {
        "configById": plots, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1}, "layout": layout,
    })  # fmt: skip


def _stacked(panels: Sequence[str]) -> Any:
    """Panels of equal height one above the other, in a tree of two branches each."""
    if len(panels) == 1:
        return panels[0]
    share = 100 / len(panels)
    return {"first": panels[0], "second": _stacked(panels[1:]), "direction": "column", "splitPercentage": share}


def write_plotjuggler(content: Content, path: Path) -> None:
    """Write a layout of PlotJuggler that loads ``run.mcap`` beside it; its curves have the same names when PlotJuggler
    is connected to the bridge of a live run.

    Format: as ``MainWindow::loadLayoutFromFile`` and ``DataLoadMCAP::xmlLoadState`` of PlotJuggler 3.17 read it.
    """
    root = ElementTree.Element("root")
    tabs = ElementTree.SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    tab = ElementTree.SubElement(tabs, "Tab", containers="1", tab_name=escape_controls(content.record.title))
    container = ElementTree.SubElement(tab, "Container")
    halves = [half for half in _halves(_groups(content)) if half]
    across = _splitter(container, "|", len(halves))
    for half in halves:
        down = _splitter(across, "-", len(half))
        for group in half:
            area = ElementTree.SubElement(down, "DockArea", name=group.title)
            plot = ElementTree.SubElement(
                area, "plot", mode="TimeSeries", style="Lines", flip_x="false", flip_y="false"
            )
            ElementTree.SubElement(plot, "limitY")
            for column, colour in _coloured(group):
                name = f"{SIGNALS_TOPIC}/{ros_name(column)}"
                ElementTree.SubElement(plot, "curve", name=name, color=colour)
    ElementTree.SubElement(tabs, "currentTabIndex", index="0")
    files = ElementTree.SubElement(root, "previouslyLoaded_Datafiles")
    plugin = ElementTree.SubElement(
        ElementTree.SubElement(files, "fileInfo", filename="run.mcap", prefix=""), "plugin", ID="DataLoad MCAP"
    )
    ElementTree.SubElement(
        plugin, "parameters", selected_topics=SIGNALS_TOPIC, use_timestamp="0", use_mcap_log_time="1",
        clamp_large_arrays="1", max_array_size="500",
    )  # fmt: skip
    ElementTree.indent(root)
    path.write_text(ElementTree.tostring(root, "unicode", xml_declaration=True) + "\n", encoding="utf-8", newline="\n")


def _splitter(parent: ElementTree.Element, orientation: str, count: int) -> ElementTree.Element:
    sizes = ";".join([f"{1 / count:.6f}"] * count)
    return ElementTree.SubElement(parent, "DockSplitter", orientation=orientation, count=str(count), sizes=sizes)


def write_asammdf(content: Content, path: Path) -> None:
    """Write a display file of asammdf (``.dspf``) for ``run.mf4``: a window for each chart.

    Format: as ``load_channel_list`` and ``load_window`` of asammdf 8.8 read it.
    """
    windows = []
    halves = _halves(_groups(content))
    for column, half in enumerate(halves):
        height_px = _HEIGHT_PX // max(1, len(half))
        for row, group in enumerate(half):
            channels = [
                {
                    "type": "channel", "name": name, "unit": content.units[name], "color": colour, "enabled": True,
                    "common_axis": True, "individual_axis": False, "computed": False, "ranges": [], "precision": 3,
                    "fmt": "{}", "format": "phys", "mode": "phys", "flags": 0, "y_range": [], "origin_uuid": "railhil",
                }
                for name, colour in _coloured(group)
            ]  # fmt: skip
            windows.append({
                "type": "Plot", "title": group.title, "maximized": False, "minimized": False,
                "geometry": [column * _WIDTH_PX // 2, row * height_px, _WIDTH_PX // 2, height_px],
                "configuration": {"channels": channels, "pattern": {}, "hide_bookmarks": True},
            })  # fmt: skip
    first = windows[0]["title"] if windows else ""
    _write_json(path, {
        "selected_channels": [], "windows": windows, "active_window": first, "functions": {}, "global_variables": "",
    })  # fmt: skip


def _groups(content: Content) -> list[ColumnGroup]:
    return grouped(content.shown.columns, content.shown.command)


def _halves(panels: Sequence[Any]) -> tuple[Sequence[Any], Sequence[Any]]:
    """The panels of the left and of the right half of the screen."""
    middle = -(-len(panels) // 2)
    return panels[:middle], panels[middle:]


def _coloured(group: ColumnGroup) -> list[tuple[str, str]]:
    """Name and colour of each column of a group."""
    return [(column.name, _COLOURS[at % len(_COLOURS)]) for at, column in enumerate(group.columns)]


def _write_json(path: Path, document: dict[str, Any]) -> None:
    path.write_text(json.dumps(document, ensure_ascii=False, indent=1) + "\n", encoding="utf-8", newline="\n")
