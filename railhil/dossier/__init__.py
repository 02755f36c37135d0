"""``railhil dossier``: what folders of evidence show of each requirement, for an assessor."""
