# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
"""Sources: blocks, losses, threads, Ctrl-C."""
import asyncio
import selectors
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


def test_a_replay_keeps_the_recorded_times_and_takes_its_own(capture):
    """A second of capture, four times as fast, cannot come in less than a quarter of a second."""
    began = time.monotonic()
    with capture.play(speed=4.0) as source:
        frames = np.concatenate(list(source.blocks(0.2)))
    assert np.array_equal(frames, capture.frames)
    assert time.monotonic() - began > 0.2
    with pytest.raises(ValueError, match="speed"):
        capture.play(speed=0.0)


def test_a_capture_is_emulated_as_a_device(capture):
    with capture.emulate(speed=10.0) as uri, ada4571.open_device(uri) as source:
        block = source.read(100, timeout_s=5.0)
        assert 0 < block.size <= 100
        assert np.allclose(block["vsin_v"], capture.vsin_v[:block.size], atol=1e-3)


def test_a_selector_waits_for_frames(capture):
    with selectors.DefaultSelector() as selector, capture.play(speed=20.0) as source:
        source.start()
        selector.register(source, selectors.EVENT_READ)
        got = []
        while not source.ended:
            assert selector.select(timeout=30.0), "nothing came"
            while (frames := source.read(4096, timeout_s=0.0)).size:
                got.append(frames.copy())
    assert np.array_equal(np.concatenate(got), capture.frames)


def test_asyncio_waits_for_frames(capture):
    async def collect(source):
        loop, done, count = asyncio.get_running_loop(), asyncio.Event(), 0

        def ready():
            nonlocal count
            count += source.read(4096, timeout_s=0.0).size
            if source.ended:
                loop.remove_reader(source)
                done.set()

        source.start()
        loop.add_reader(source, ready)
        await asyncio.wait_for(done.wait(), 60.0)
        return count

    with capture.play(speed=20.0) as source:
        assert asyncio.run(collect(source)) == len(capture)


def test_a_descriptor_is_quiet_while_nothing_comes(seed):
    """After a read that told of nothing, until the next frame a hundred seconds on."""
    with ada4571.Simulation(seed=seed, sample_rate_hz=0.01).open(realtime=True) as source:
        source.start()
        with selectors.DefaultSelector() as selector:
            selector.register(source, selectors.EVENT_READ)
            while source.read(1, timeout_s=0.0).size:
                pass
            assert not selector.select(timeout=0.3) and not source.ended
            source.cancel()
            assert selector.select(timeout=30.0)
            assert source.read(1, timeout_s=0.0).size == 0 and source.ended


def test_stored_configurations_are_listed(seed, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert "bench" not in [entry["name"] for entry in ada4571.stored()]
    with ada4571.Simulation(seed=seed).emulate() as uri:
        with ada4571.open_device(uri) as source:
            source.set_buffer(128)
            source.save("bench")
    entry = next(e for e in ada4571.stored() if e["name"] == "bench")
    assert entry["uri"] == uri and not entry["problem"]
    assert ada4571.stored("bench") == [entry]
    (tmp_path / "ada4571" / "broken.toml").write_text("what")
    assert next(e for e in ada4571.stored() if e["name"] == "broken")["problem"]
    with pytest.raises(ada4571.Error):
        ada4571.stored("broken")


def test_what_is_no_device_has_no_buffer_and_no_driver(capture):
    with capture.play() as source:
        with pytest.raises(ada4571.UnsupportedError):
            source.set_buffer(64)
        with pytest.raises(ada4571.Error):
            source.write_calibration(ada4571.Model())
