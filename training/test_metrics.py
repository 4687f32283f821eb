"""The ranks among the pixels' errors are those that image/metrics/metrics.h defines, so that both programs tell the same numbers."""
import pytest
import torch

import metrics


def test_ranks_of_the_errors():
    errors = torch.arange(2500.0)[torch.randperm(2500, generator=torch.Generator().manual_seed(1))].reshape(1, 50, 50)
    numbers = metrics.all_metrics((0.01 * errors).sqrt().expand(3, -1, -1), torch.zeros(3, 50, 50))
    assert numbers["relmse"] == pytest.approx(1249.5, rel=1e-6)
    assert numbers["relmse_median"] == pytest.approx(1249.5, rel=1e-6)
    assert numbers["relmse_trimmed"] == pytest.approx(1248.5, rel=1e-6)  # without 2 pixels
    assert numbers["relmse_p999"] == pytest.approx(2497, rel=1e-6)
