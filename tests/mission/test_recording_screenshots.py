"""Pictures of a recording's tabs: all there, and no view has anything to complain of."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mission.recording.screenshots import NoViewer, main, screenshots
from tests.mission.recording_story import story
from tests.mission.rerun_file import record


@pytest.mark.slow
def test_every_tab_is_drawn_and_no_view_reports_an_error(tmp_path: Path) -> None:
    recording = record(tmp_path / "mission.rrd", story())
    try:
        assert screenshots(recording, tmp_path / "pictures", size="800x600") == []
    except NoViewer as error:
        pytest.skip(str(error))
    pictures = {path.name: Image.open(path).convert("RGB") for path in (tmp_path / "pictures").iterdir()}
    assert set(pictures) == {"mission.png", "wall-1.2.png", "wall-1.3.png", "results.png"}
    for name, picture in pictures.items():
        assert len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0)) > 50, name  # not blank
        assert (tmp_path / "pictures" / name).stat().st_size < 400_000
    assert main([str(recording), "--tab", "Walls"]) == 2


def test_without_a_recording_there_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path / "none.rrd")]) == 2
    assert capsys.readouterr().err == f"error: no such recording: {tmp_path / 'none.rrd'}\n"
