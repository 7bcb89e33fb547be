#!/usr/bin/env bash
# Starts a Slurm of two nodes with one processor each on this machine alone, for tests/test_slurm.py.
# Needs root and Debian. Does nothing where a Slurm answers already.
set -euo pipefail

if command -v sinfo >/dev/null && timeout 10 sinfo --noheader >/dev/null 2>&1; then
    echo "a Slurm is there already"
    exit 0
fi
if ! command -v slurmctld >/dev/null; then
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        slurmctld slurmd slurm-client munge >/dev/null
fi
if [ -e /etc/slurm/slurm.conf ] && ! grep -q '^ClusterName=prime$' /etc/slurm/slurm.conf; then
    echo "/etc/slurm/slurm.conf is of another cluster: it is left alone" >&2
    exit 1
fi
state=$(mktemp -d)
host=$(hostname -s)
mkdir -p /run/munge /var/log/munge /etc/slurm
chown -R munge: /run/munge /var/log/munge
pgrep -x munged >/dev/null || runuser -u munge -- munged
cat > /etc/slurm/slurm.conf <<EOF
ClusterName=prime
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
StateSaveLocation=$state/controller
SlurmdSpoolDir=$state/%n
SlurmctldPidFile=$state/controller.pid
SlurmdPidFile=$state/%n.pid
SlurmctldLogFile=$state/controller.log
SlurmdLogFile=$state/%n.log
NodeName=prime1 NodeHostname=$host NodeAddr=127.0.0.1 Port=17101 CPUs=1 RealMemory=3500
NodeName=prime2 NodeHostname=$host NodeAddr=127.0.0.1 Port=17102 CPUs=1 RealMemory=3500
PartitionName=main Nodes=prime[1-2] Default=YES MaxTime=INFINITE State=UP
EOF
mkdir -p "$state/controller" "$state/prime1" "$state/prime2"
slurmctld
slurmd -N prime1
slurmd -N prime2
for _ in $(seq 30); do
    if [ "$(sinfo --noheader --format=%T 2>/dev/null | sort -u)" = idle ]; then
        sinfo
        exit 0
    fi
    sleep 1
done
echo "Slurm did not start; its logs are in $state" >&2
exit 1
