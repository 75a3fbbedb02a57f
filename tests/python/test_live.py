# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Sources: blocks, losses, threads, Ctrl-C."""
import threading
import time

import numpy as np
import pytest

import ada4571


def test_blocks_hold_the_whole_recording(capture):
    with capture.play() as source:
        blocks = list(source.blocks(0.1))
    assert len(blocks) == 10 and {block.size for block in blocks} == {1000}
    assert np.array_equal(np.concatenate(blocks), capture.frames)


def test_a_recording_without_a_rate_comes_by_its_times(capture, tmp_path):
    path = tmp_path / "uneven.csv"
    rows = "".join(f"{t:.4f},2.5,3.5\n" for t in np.cumsum(np.tile([0.001, 0.004], 500)))
    path.write_text("# ada4571-capture/1\ntime_s,vsin_v,vcos_v\n" + rows)
    with ada4571.Recording(path).play() as source:
        assert sum(block.size for block in source.blocks(0.5)) == 1000


def test_lost_samples_are_said(capture, tmp_path):
    path = tmp_path / "gap.csv"
    with ada4571.Writer(path, reference=True, sample_rate_hz=10000) as writer:
        writer.write(capture.frames[:3000])
        writer.write(capture.frames[3007:])
    with ada4571.Recording(path).play() as source:
        with pytest.warns(ada4571.LostSamplesWarning, match="^7 samples are lost$"):
            sizes = [block.size for block in source.blocks(0.1)]
        assert sum(sizes) == len(capture) - 7 and source.statistics["lost"] == 7


def test_an_emulated_device_is_read_as_any_other(seed):
    bench = ada4571.Simulation(seed=seed)
    with bench.emulate() as uri:
        assert len(ada4571.devices(uri)) == 1
        with ada4571.open_device(uri) as source:
            block = next(source.blocks(0.05))
            assert block.dtype == ada4571.frame_dtype and np.isfinite(block["vsin_v"]).all()
            assert source.info["has_vtemp"] and "closed" not in repr(source)
    assert "closed" in repr(source)


def test_no_such_device_is_said():
    with pytest.raises(ada4571.Error, match="127.0.0.1"):
        ada4571.open_device("ip:127.0.0.1:1")
    with pytest.raises(FileNotFoundError, match="no-such-name"):
        ada4571.open("no-such-name")


def test_a_silent_source_times_out(seed):
    """One sample in a hundred seconds: nothing comes in time, after the first."""
    bench = ada4571.Simulation(seed=seed, sample_rate_hz=0.01)
    with bench.open(realtime=True) as source:
        with pytest.raises(TimeoutError):
            list(source.blocks(1000.0, timeout_s=0.1))


def test_a_cancel_from_another_thread_ends_the_read(seed):
    bench = ada4571.Simulation(seed=seed, sample_rate_hz=0.01)
    with bench.open(realtime=True) as source:
        source.read(1)
        threading.Timer(0.2, source.cancel).start()
        assert source.read(1, timeout_s=-1).size == 0


def test_other_threads_run_during_long_calls(seed):
    """With the interpreter held, this thread could not count while the library works."""
    bench, counts, done = ada4571.Simulation(seed=seed), [0], threading.Event()

    def count():
        while not done.is_set():
            counts[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    handle = bench._new(20.0)  # 200000 samples: many times an interval at which threads change
    before = counts[0]
    handle.run()
    after = counts[0]
    done.set()
    thread.join()
    assert after - before > 100
