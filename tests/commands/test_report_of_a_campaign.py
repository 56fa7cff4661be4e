"""`executive report` of a campaign's folder writes the page of the campaign, and tells it."""

from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.reporting import report as reporting
from tests.commands.in_process import executive


def test_a_folder_with_results_is_that_of_a_campaign(monkeypatch, capsys, tmp_path):
    CampaignFolder(tmp_path).results.write_text("", encoding="utf-8")
    (tmp_path / reporting.FIGURES).write_text('{"placed": 3}\n', encoding="utf-8")
    asked = []
    monkeypatch.setattr(reporting, "report_campaign", asked.append)
    assert executive(monkeypatch, "report", tmp_path) == 0
    said = capsys.readouterr()
    assert said.err == f"report     {tmp_path / reporting.PAGE}\n"
    assert said.out == ""
    assert executive(monkeypatch, "report", tmp_path, "--json") == 0
    assert capsys.readouterr().out == '{"placed": 3}\n'
    assert asked == [tmp_path] * 2


def test_a_folder_without_results_is_no_campaign(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(reporting, "report_campaign", lambda folder: 1 / 0)
    assert executive(monkeypatch, "report", tmp_path) == 2
    assert "error: " in capsys.readouterr().err
