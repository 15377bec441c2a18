"""Studies on a Dask cluster of two worker processes."""

import os
import signal

import numpy as np
import pytest

from stiffmbs import sweep

distributed = pytest.importorskip("distributed")


@pytest.fixture
def client(tmp_path):
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(tmp_path)
        ) as cluster,
        distributed.Client(cluster) as found,
    ):
        yield found


@pytest.mark.long
def test_a_table_survives_a_worker_that_is_killed(examples, client):
    scene, k_b = examples / "half_car.yaml", np.logspace(5, 7, 24)
    outputs = ["peak(front_bushing.fx)", "chassis.y"]
    workers = list(client.run(os.getpid).values())
    killed = []

    def kill_one(done, *_):
        if done >= 4 and not killed:
            killed.append(workers[0])
            os.kill(workers[0], signal.SIGKILL)

    found = sweep(scene, k_b=k_b, outputs=outputs, rtol=1e-6, executor=client.get_executor(), watch=kill_one)
    assert killed and len(workers) == 2
    assert found.identical(sweep(scene, k_b=k_b, outputs=outputs, rtol=1e-6))
