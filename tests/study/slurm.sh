#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# slurm.sh BUILD: tools/study.sbatch on a real Slurm of this test's own: munged, slurmctld and slurmd
# on loopback, with configuration, key and state in a folder that is removed. Ends with 77 (skipped)
# where they are not installed.
set -u
BUILD=$(cd "$1" && pwd)
SOURCE=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$BUILD/tools:$PATH:/usr/sbin
for tool in munged slurmctld slurmd sbatch sqlite3; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed" && exit 77; }
done
[[ $(id -u) == 0 ]] || { echo "skipped: slurmd runs as root only" && exit 77; }
# slurmd does not start without control groups, which a bare chroot or container need not have.
[[ $(stat -f -c %T /sys/fs/cgroup 2>/dev/null) =~ ^(cgroup2fs|tmpfs)$ ]] ||
  { echo "skipped: there are no control groups at /sys/fs/cgroup" && exit 77; }

WORK=$(mktemp -d /tmp/ada4571-slurm-XXXXXX)
export SLURM_CONF=$WORK/slurm.conf IIO_ANGLE=$BUILD/tools/iio-angle
NODE=$(hostname -s)
PIDS=()

fail() {
  if grep -qs "Unable to initialize cgroup plugin" "$WORK/slurmd.log"; then
    echo "skipped: slurmd cannot use the control groups here" && exit 77
  fi
  echo "FAILED: $*" && tail -n 15 "$WORK"/*.log "$WORK"/bench.db.parts/*.log && ls -l "$WORK"/bench.db* && exit 1
}

stop_all() {
  local file pid i
  for file in "$WORK"/slurmd.pid "$WORK"/slurmctld.pid; do
    [[ -s $file ]] || continue
    pid=$(<"$file")
    kill "$pid" 2>/dev/null
    for ((i = 0; i < 100; i++)); do # it saves its state in the folder
      kill -0 "$pid" 2>/dev/null && sleep 0.1
    done
  done
  ((${#PIDS[@]} == 0)) || kill "${PIDS[@]}" 2>/dev/null
  wait 2>/dev/null
  rm -rf "$WORK"
}
trap stop_all EXIT

free_port() {
  python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

configure() {
  chmod 755 "$WORK"
  mkdir "$WORK/state" "$WORK/spool"
  cat >"$SLURM_CONF" <<CONF
ClusterName=ada4571
SlurmctldHost=$NODE(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$WORK/munge.socket
CredType=cred/munge
StateSaveLocation=$WORK/state
SlurmdSpoolDir=$WORK/spool
SlurmctldPidFile=$WORK/slurmctld.pid
SlurmdPidFile=$WORK/slurmd.pid
SlurmctldLogFile=$WORK/slurmctld.log
SlurmdLogFile=$WORK/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,bf_interval=1,sched_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=20
MinJobAge=600
MpiDefault=none
NodeName=$NODE NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$NODE Default=YES MaxTime=INFINITE State=UP
CONF
  dd if=/dev/urandom of="$WORK/munge.key" bs=128 count=1 2>/dev/null
  chmod 400 "$WORK/munge.key"
}

start_munge() {
  munged --force --foreground --socket="$WORK/munge.socket" --key-file="$WORK/munge.key" \
    --pid-file="$WORK/munged.pid" --seed-file="$WORK/munge.seed" --log-file="$WORK/munged.log" \
    >"$WORK/munged.out" 2>&1 &
  PIDS+=($!)
  until_true "munged answers" test -S "$WORK/munge.socket"
}

# until_true WHAT COMMAND...: as long as it takes, but not for ever.
until_true() {
  local what=$1 i
  shift
  for ((i = 0; i < 6000; i++)); do
    ! "$@" >/dev/null 2>&1 || return 0
    sleep 0.1
  done
  fail "never: $what"
}

node_is_up() { sinfo -h -o %T | grep -qE 'idle|mixed|allocated|completing'; }
done_in() { [[ $(sqlite3 "$1" "SELECT count(*) FROM captures WHERE state = 'done'" 2>/dev/null) -ge $2 ]]; }
queue_is_empty() { [[ -z $(squeue -h -r) ]]; }

task_runs() { squeue -h -r -t R -o %i | grep -q _; }
# It runs after two minutes: until then slurmd takes no task of a number that it saw end.
task_was_requeued() { grep -q '_job_complete: requeue JobId=' "$WORK/slurmctld.log"; }

# Daemon, what watches over its tasks, and the tasks, at once and without a word.
node_dies() {
  local tasks watchers
  mapfile -t tasks < <(scontrol listpids | awk 'NR > 1 && $1 > 1 { print $1 }')
  ((${#tasks[@]} > 0)) || fail "no processes of a task"
  mapfile -t watchers < <(ps -o ppid= -p "${tasks[*]}" | awk '$1 > 1 { print $1 }')
  kill -9 "$(<"$WORK/slurmd.pid")" "${watchers[@]}" "${tasks[@]}" 2>/dev/null
}

make_captures() { # make_captures COUNT
  local k
  mkdir -p "$WORK/captures"
  for ((k = 1; k <= $1; k++)); do
    iio-angle simulate --seed "$k" --rate 1000 --duration 15 -o "$WORK/captures/c$k.csv" || return 1
    echo "$WORK/captures/c$k.csv"
  done >"$WORK/names"
}

every_capture_once() { # every_capture_once STUDY
  [[ $(sqlite3 "$1" "SELECT count(*), count(DISTINCT capture), sum(state = 'done') FROM captures") \
    == "$COUNT|$COUNT|$COUNT" ]] || fail "not every capture once: $(sqlite3 "$1" 'SELECT capture, state FROM captures')"
}

COUNT=12
configure
start_munge
slurmctld -c
until_true "slurmctld answers" scontrol ping
slurmd
until_true "the node is up" node_is_up
echo "Slurm $(sinfo --version | cut -d' ' -f2) with node $NODE"
make_captures $COUNT || fail "no captures"

cd "$WORK" || exit 1
submitted=$("$SOURCE/tools/study.sbatch" names "$WORK/bench.db" 4) || fail "cannot submit"
echo "$submitted"
array=${submitted#array }
# A task is killed in the middle: the whole of it, as by a power cut.
until_true "a shard has begun" done_in "$WORK/bench.db.parts/part-00001.db" 1
scancel --full --signal=KILL "${array%%,*}_1" || fail "no task to kill"
echo "a task was killed"
# The node dies, and comes back: its task is queued again.
until_true "a task is running" task_runs
node_dies
slurmd
until_true "the node is up again" node_is_up
until_true "the task is queued again" task_was_requeued
echo "the node died, and its task was queued again"
# The node's daemon stops and starts; its tasks live on.
until_true "a task is running" task_runs
kill "$(<"$WORK/slurmd.pid")"
sleep 2
slurmd
until_true "the node is up again" node_is_up
echo "the node daemon was stopped and started"
until_true "all jobs end" queue_is_empty
until_true "the merge is there" test -s "$WORK/bench.db"
before=$(sqlite3 "$WORK/bench.db" "SELECT count(*) FROM captures WHERE state = 'done'")
grep -E "not done|missing" "$WORK/bench.db.parts/merge.log" >"$WORK/lost" 
echo "first run: $before of $COUNT done, $(wc -l <"$WORK/lost") named as lost"
# A shard whose task was killed before it had listed its captures is one line.
named=$((before + $(wc -l <"$WORK/lost")))
((named == COUNT)) || { ((named < COUNT)) && grep -q '^shard .* is missing' "$WORK/lost"; } ||
  fail "what is lost is not named: $(cat "$WORK/bench.db.parts/merge.log")"
# A task that ended well has left nothing.
for k in 1 2 3 4; do
  grep -qE "_job_complete: JobId=[0-9]+_$k\([0-9]+\) WEXITSTATUS 0" "$WORK/slurmctld.log" || continue
  left=$(sqlite3 "$WORK/bench.db.parts/part-0000$k.db" "SELECT count(*) FROM captures WHERE state != 'done'")
  [[ $left == 0 ]] || fail "shard $k: '$left' captures are not done, and its task ended with 0"
done

# The same again does the rest; a shard that is run twice changes nothing.
"$SOURCE/tools/study.sbatch" names "$WORK/bench.db" 4 || fail "cannot submit again"
until_true "all jobs end" queue_is_empty
SLURM_ARRAY_TASK_ID=2 "$SOURCE/tools/study.sbatch" shard names "$WORK/bench.db" 4 || fail "shard 2 again"
"$SOURCE/tools/study.sbatch" merge "$WORK/bench.db" 4 || fail "something is still missing"
every_capture_once "$WORK/bench.db"

# One machine, no Slurm: the same file.
iio-angle study run --list names -o whole.db 2>/dev/null || fail "one run"
iio-angle study merge -o one.db whole.db || fail "merge of one"
cmp one.db bench.db || fail "the cluster's study is another than one machine's"
echo "every capture exactly once, and the same file as on one machine"
