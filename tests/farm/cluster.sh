# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh: a Slurm of two nodes on this host, with its own key, socket, ports and folders, so
# that a Slurm that runs here already is not disturbed.

cluster_programs=(munged slurmctld slurmd sbatch squeue scancel scontrol sinfo)
daemons=()  # process ids, in the order of their start

# free_ports COUNT: that many ports that nobody listens on.
free_ports() {
  local port found=0
  for port in $(shuf -i 20000-30000 -n 200); do
    if (: <>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then continue; fi
    echo "$port"
    found=$((found + 1))
    [ "$found" -lt "$1" ] || return 0
  done
  echo "no free ports" >&2
  return 1
}

# write_slurm_conf FOLDER: nodes of more processors and memory than the host need not have.
write_slurm_conf() {
  local folder=$1 ports
  mapfile -t ports < <(free_ports 3)
  cat >"$folder/slurm.conf" <<CONF
ClusterName=ssdo_test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool_%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd_%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd_%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=0
SlurmdParameters=config_overrides
MailProg=/bin/true
KillWait=5
ReturnToService=2
NodeName=n1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=${ports[1]} CPUs=8 RealMemory=4096
NodeName=n2 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=${ports[2]} CPUs=8 RealMemory=4096
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=10 State=UP
CONF
}

# start_daemon NAME COMMAND...: in the foreground of a child, so that its id is known.
start_daemon() {
  "${@:2}" >"$cluster/$1.out" 2>&1 &
  daemons+=($!)
}

nodes_are_idle() { [ "$(sinfo --noheader --Node --format=%t | sort -u)" = idle ]; }

# start_cluster FOLDER: sets SLURM_CONF.
start_cluster() {
  cluster=$1
  mkdir -p "$cluster"/{state,spool_n1,spool_n2}
  write_slurm_conf "$cluster"
  export SLURM_CONF=$cluster/slurm.conf
  head -c 1024 /dev/urandom >"$cluster/munge.key"
  chmod 400 "$cluster/munge.key"
  start_daemon munged munged --foreground --key-file="$cluster/munge.key" \
    --socket="$cluster/munge.socket" --pid-file="$cluster/munged.pid" \
    --log-file="$cluster/munged.log" --seed-file="$cluster/munge.seed"
  wait_until 20 "munged to open its socket" test -S "$cluster/munge.socket"
  start_daemon slurmctld slurmctld -D
  start_daemon slurmd_n1 slurmd -D -N n1
  start_daemon slurmd_n2 slurmd -D -N n2
  wait_until 60 "both nodes to be idle" nodes_are_idle
}

# Ends tasks first: they would outlive their daemons.
stop_cluster() {
  local i
  [ ${#daemons[@]} -gt 0 ] || return 0
  scancel --user=root 2>/dev/null || true
  for ((i = ${#daemons[@]} - 1; i >= 0; i--)); do
    kill "${daemons[i]}" 2>/dev/null || true
    wait "${daemons[i]}" 2>/dev/null || true
  done
  daemons=()
}

# Logs of the daemons, for a failure.
show_cluster_logs() { tail -n 20 log/* "$cluster"/*.log "$cluster"/*.out; }
